-- expect: SCRIPT:2: gr.mesh: faces is missing; the call is gr.mesh(name, verts, faces) (node 'flag')
gr.mesh('flag', {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}})
