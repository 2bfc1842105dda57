-- expect: SCRIPT:2: gr.render: tone: tone_colour.lua:2: the function must return a number, not a table
gr.render{node = gr.node('r'), file = 'a.png', width = 4, height = 4, eye = {0, 0, 5}, tone = function(x) return {x, x, x} end}
