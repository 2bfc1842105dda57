-- expect: SCRIPT:2: gr.render: view and target exclude each other
gr.render{node = gr.node('n'), file = 'no.png', width = 8, height = 8, eye = {0, 0, 5}, view = {0, 0, -1}, target = {0, 0, 0}}
