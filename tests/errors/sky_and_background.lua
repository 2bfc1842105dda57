-- expect: SCRIPT:2: gr.render: sky and background exclude each other
gr.render{node = gr.node('n'), file = 'no.png', width = 8, height = 8, eye = {0, 0, 5}, sky = 'a.png', background = {0, 0, 0}}
