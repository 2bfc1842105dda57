-- expect: SCRIPT:2: gr.sphere: radius must be > 0 (node 'eye')
gr.sphere{name = 'eye', radius = -2}
