-- expect: SCRIPT:2: gr.csg_union: mesh 'flag' of lib/triangle.obj is not closed, so it has no inside: the edge from {0, 0, 0} to {1, 0, 0} is open (node 'u')
gr.csg_union('u', gr.sphere('s'), gr.mesh('flag', 'lib/triangle.obj'))
