-- expect: SCRIPT:2: gr.mesh: faces[1] must be a table of indices, not a number (node 'flag')
gr.mesh('flag', {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {1, 2, 3})
