-- expect: SCRIPT:2: gr.render: shutter must not end before it begins
gr.render{node = gr.sphere('b'), file = 'x.png', width = 8, height = 8, eye = {0, 0, 5}, shutter = {1, 0}}
