-- expect: SCRIPT:3: gr.render: the grid of the medium needs corner and size, for it fills no solid
local smoke = gr.medium{scattering = {1, 1, 1}, cells = {1, 1, 2}, density = {1, 2}}
gr.render{node = gr.node('scene'), file = 'a.png', width = 4, height = 4, medium = smoke}
