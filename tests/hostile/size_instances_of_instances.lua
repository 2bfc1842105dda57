-- expect: SCRIPT:9: gr.render: the scene places more than 268435456 primitives (instances of instances?)
-- 10^12 balls from forty nodes.
local node = gr.node('leaf')
node:add_child(gr.sphere{})
for i = 1, 40 do
    local both = gr.node('n' .. i)
    both:add_child(node) both:add_child(node) node = both
end
gr.render{node = node, file = 'x.png', width = 8, height = 8, eye = {0, 0, 9}}
