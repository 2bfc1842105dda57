-- expect: SCRIPT:5: gr.render: node 'mesh' is an operand of CSG but its mesh of lib/triangle.obj is open: the edge from (0, 0, 0) to (1, 0, 0) belongs to one face only, or to faces that disagree about the outside
local m = gr.material({1, 1, 1}, {0, 0, 0}, 1)
local group = gr.node('group')
group:add_child(gr.mesh(m, 'lib/triangle.obj'))
gr.render(gr.csg_union('u', gr.sphere(m), group), 'no.png', 8, 8, {0, 0, 5}, {0, 0, -1}, {0, 1, 0}, 50, {0, 0, 0}, {})
