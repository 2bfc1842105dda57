-- expect: SCRIPT:2: gr.mesh: faces[1][3] is 1000000000, but verts ends with number 0, counted from 0 (node 'm')
gr.mesh('m', {{0, 0, 0}}, {{0, 0, 1000000000}})
