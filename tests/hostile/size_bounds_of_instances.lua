-- expect: SCRIPT:9: node:bounds: more than 16777216 objects are below this node (node 'n40')
-- arguments: --script-time 30
local node = gr.node('leaf')
node:add_child(gr.sphere{})
for i = 1, 40 do
    local both = gr.node('n' .. i)
    both:add_child(node) both:add_child(node) node = both
end
node:bounds()
