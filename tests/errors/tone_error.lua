-- expect: SCRIPT:2: gr.render: tone: tone_error.lua:2: attempt to index a number value (local 'x')
gr.render{node = gr.node('r'), file = 'a.png', width = 4, height = 4, eye = {0, 0, 5}, tone = function(x) return x.r end}
