-- expect: SCRIPT:3: gr.render: node 'b' moves to its mirror image, which no rotation reaches
local b = gr.sphere('b'):moves_to(gr.node('there'):scale(1, 1, -1))
gr.render{node = b, file = 'x.png', width = 8, height = 8, eye = {0, 0, 5}, lights = {}}
