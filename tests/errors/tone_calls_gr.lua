-- expect: SCRIPT:2: gr.render: tone: tone_calls_gr.lua:2: gr.sphere cannot be called by a tone curve
gr.render{node = gr.node('r'), file = 'a.png', width = 4, height = 4, eye = {0, 0, 5}, tone = function(x) return gr.sphere(x) end}
