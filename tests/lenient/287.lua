local red = gr.material({0.8, 0.2, 0.1}, {0.4, 0.4, 0.4}, 30)
local root = gr.node('root')
local ball = gr.sphere('ball')
ball:set_material(red)
root:add_child(ball)
local lamp = gr.light({3, 5, 8}, {0.9, 0.9, 0.9}, {1, 0, 0})
gr.render{world = root, filename = '287.png', width = 16, height = 16, camera = {0, 0, 6}, lamps = {lamp}}
