-- expect: SCRIPT:2: gr.mesh: faces[1][3] is -1: indices count from 0 (node 'flag')
gr.mesh('flag', {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, -1}})
