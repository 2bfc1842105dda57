-- expect: SCRIPT:3: gr.render: node 'ball': its material is opaque, so no light reaches its medium
local ball = gr.sphere{name = 'ball', material = gr.material({1, 0, 0}, {0, 0, 0}, 1), medium = gr.medium{scattering = {1, 1, 1}}}
gr.render{node = ball, lights = {gr.light{position = {1, 1, 1}, colour = {1, 1, 1}}}, file = 'no.png', width = 8, height = 8, eye = {0, 0, 5}}
