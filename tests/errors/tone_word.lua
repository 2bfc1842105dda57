-- expect: SCRIPT:2: gr.render: tone must be 'none', 'reinhard' or 'filmic', not 'filmik'
gr.render{node = gr.node('r'), file = 'a.png', width = 4, height = 4, eye = {0, 0, 5}, tone = 'filmik'}
