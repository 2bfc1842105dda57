-- expect: SCRIPT:5: gr.render: a CSG solid has more than 65535 operands
-- The same with solids.
local solid = gr.sphere{material = gr.material({1, 1, 1}, {0, 0, 0}, 1)}
for _ = 1, 40 do solid = gr.union{a = solid, b = solid} end
gr.render{node = solid, file = 'x.png', width = 8, height = 8, eye = {0, 0, 9}, lights = {}}
