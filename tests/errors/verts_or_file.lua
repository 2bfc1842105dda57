-- expect: SCRIPT:2: gr.mesh: verts is missing (or file, the name of a mesh file) (node 'flag')
gr.mesh{name = 'flag'}
