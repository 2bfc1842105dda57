-- expect: SCRIPT:11: gr.render: the scene places more than 268435456 primitives (instances of instances?)
-- 10^12 balls from 121 nodes.
local node = gr.node('leaf')
node:add_child(gr.sphere{})
for i = 1, 40 do
    local both = gr.node('n' .. i)
    local left, right = gr.node('left'), gr.node('right')
    left:add_child(node) right:add_child(node)
    both:add_child(left) both:add_child(right) node = both
end
gr.render{node = node, file = 'x.png', width = 8, height = 8, eye = {0, 0, 9}, lights = {}}
