-- expect: SCRIPT:2: gr.mesh: verts is missing (or file, the name of an OBJ file) (node 'flag')
gr.mesh{name = 'flag'}
