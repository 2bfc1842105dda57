-- expect: SCRIPT:2: gr.clipped_by: 'd' is flat, so it has no inside; only a plane with a normal is a half-space (node 'c')
gr.clipped_by('c', gr.sphere('s'), gr.disc{name='d'})
