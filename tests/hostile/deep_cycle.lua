-- expect: SCRIPT:5: node:add_child: 'b' is below 'a': the nodes would form a cycle (node 'b')
-- Nodes that contain each other.
local a, b = gr.node('a'), gr.node('b')
a:add_child(b)
b:add_child(a)
gr.render{node = a, file = 'x.png', width = 8, height = 8, eye = {0, 0, 9}}
