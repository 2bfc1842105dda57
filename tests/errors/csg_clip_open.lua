-- expect: SCRIPT:2: gr.clipped_by: 'd' is flat, so it has no inside; only a plane with a normal stands for the half-space behind it (node 'c')
gr.clipped_by('c', gr.sphere('s'), gr.disc{name='d'})
