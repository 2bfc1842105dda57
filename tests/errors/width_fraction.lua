-- expect: SCRIPT:2: gr.render: width must be a whole number
gr.render{node = gr.node('n'), file = 'no.png', width = 1.5, height = 8, eye = {0, 0, 5}}
