-- expect: SCRIPT:2: gr.render: accel must be 'auto', 'grid', 'bvh', 'kdtree' or 'none', not 'fast'
gr.render{node = gr.node('n'), file = 'no.png', width = 8, height = 8, eye = {0, 0, 5}, accel = 'fast'}
