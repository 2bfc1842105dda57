-- expect: SCRIPT:2: gr.render: caustics.photons must be between 0 and 100000000
gr.render {node = gr.node('n'), file = 'no.png', width = 8, height = 8, eye = {0, 0, 5}, caustics = 2e8}
