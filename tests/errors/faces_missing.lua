-- expect: SCRIPT:2: gr.mesh: faces is missing (node 'flag')
gr.mesh('flag', {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}})
