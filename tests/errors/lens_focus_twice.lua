-- expect: SCRIPT:2: gr.render: focus and focus_point exclude each other
gr.render{node = gr.node('n'), file = 'no.png', width = 8, height = 8, eye = {0, 0, 5}, focus = 2, focus_point = {0, 0, 0}}
