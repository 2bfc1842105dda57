-- expect: SCRIPT:2: gr.mesh: faces[2][3] is 3, but verts ends with number 2, counted from 0 (node 'flag')
gr.mesh('flag', {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 1, 3}})
