-- expect: SCRIPT:5: gr.render: node 'mesh' is an operand of CSG but its mesh of lib/triangle.obj is open: the first open edges (of one face, or of faces that disagree about the outside) go from {0, 0, 0} to {1, 0, 0}, from {0, 0, 0} to {0, 1, 0}, from {1, 0, 0} to {0, 1, 0}; weld = 1e-05 in gr.mesh joins vertices closer than that, which closes seams but no holes
local m = gr.material({1, 1, 1}, {0, 0, 0}, 1)
local group = gr.node('group')
group:add_child(gr.mesh(m, 'lib/triangle.obj'))
gr.render(gr.csg_union('u', gr.sphere(m), group), 'no.png', 8, 8, {0, 0, 5}, {0, 0, -1}, {0, 1, 0}, 50, {0, 0, 0}, {})
