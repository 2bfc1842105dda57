-- expect: SCRIPT:2: gr.mesh: file and verts exclude each other (node 'flag')
gr.mesh{name = 'flag', file = 'lib/triangle.obj', verts = {}}
