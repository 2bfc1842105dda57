-- expect: SCRIPT:2: gr.render: tone: tone_nothing.lua:2: the function returns 0 values, not a number
gr.render{node = gr.node('r'), file = 'a.png', width = 4, height = 4, eye = {0, 0, 5}, tone = function(x) end}
