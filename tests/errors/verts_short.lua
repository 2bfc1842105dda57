-- expect: SCRIPT:2: gr.mesh: verts[1] must have 3 numbers, not 2 (node 'flag')
gr.mesh('flag', {{0, 0}}, {})
