-- expect: SCRIPT:3: gr.wood_pnd_material: more than 1000 materials are nested
local m = gr.material({1, 1, 1}, {0, 0, 0}, 1)
for i = 1, 1000 do m = gr.wood_pnd_material(m, 1, 1, 0, {1, 1, 1}) end
