-- expect: SCRIPT:2: gr.render: tone must be a word or a function, not a number
gr.render{node = gr.node('r'), file = 'a.png', width = 4, height = 4, eye = {0, 0, 5}, tone = 2}
