-- expect: SCRIPT:2: gr.render: tone: tone_nan.lua:2: the function must return finite numbers; at x = 0 it returns NaN (not a number)
gr.render{node = gr.node('r'), file = 'a.png', width = 4, height = 4, eye = {0, 0, 5}, tone = function(x) return x / x end}
