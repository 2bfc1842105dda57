-- expect: SCRIPT:2: gr.render: tone: tone_infinite.lua:2: the function must return finite numbers; at x = 0 it returns a number that is too large
gr.render{node = gr.node('r'), file = 'a.png', width = 4, height = 4, eye = {0, 0, 5}, tone = math.log}
