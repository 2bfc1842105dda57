-- expect: SCRIPT:2: gr.mesh: faces[1][3] must be a whole number (node 'flag')
gr.mesh('flag', {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 1.5}})
