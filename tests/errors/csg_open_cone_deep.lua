-- expect: SCRIPT:4: gr.render: node 'c' is an operand of CSG but has no caps (open = true), so it has no inside
local group = gr.node('group')
group:add_child(gr.cone{name='c', open=true})
gr.render(gr.csg_union('u', gr.sphere('s'), group), 'no.png', 8, 8, {0, 0, 5}, {0, 0, -1}, {0, 1, 0}, 50, {0, 0, 0}, {})
