-- expect: SCRIPT:4: gr.render: node 'c' is an operand of CSG but is clipped, cut open without caps, so it has no inside; intersect it instead
local group = gr.node('group')
group:add_child(gr.clipped_by('c', gr.sphere('s'), gr.cube('by')))
gr.render(gr.csg_union('u', gr.sphere('s'), group), 'no.png', 8, 8, {0, 0, 5}, {0, 0, -1}, {0, 1, 0}, 50, {0, 0, 0}, {})
