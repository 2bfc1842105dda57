-- expect: SCRIPT:5: gr.render: the nodes form a cycle: 'a' > 'b' > 'a'
local a, b = gr.node('a'), gr.node('b')
a:add_child(b)
b:add_child(a)
gr.render(a, 'no.png', 8, 8, {0, 0, 5}, {0, 0, -1}, {0, 1, 0}, 50, {0, 0, 0}, {})
