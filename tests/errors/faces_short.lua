-- expect: SCRIPT:2: gr.mesh: faces[1] has 2 corners, not 3 or more (node 'flag')
gr.mesh('flag', {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1}})
