-- expect: SCRIPT:2: gr.mesh: escape_buffer.gltf: *
gr.mesh('m', 'escape_buffer.gltf')
