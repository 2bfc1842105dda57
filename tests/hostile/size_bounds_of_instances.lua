-- expect: SCRIPT:11: node:bounds: more than 16777216 objects are below this node (node 'n40')
-- arguments: --script-time 30
local node = gr.node('leaf')
node:add_child(gr.sphere{})
for i = 1, 40 do
    local both = gr.node('n' .. i)
    local left, right = gr.node('left'), gr.node('right')
    left:add_child(node) right:add_child(node)
    both:add_child(left) both:add_child(right) node = both
end
node:bounds()
