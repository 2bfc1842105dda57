-- TITLE: The dining room in indirect light
-- OPTIONS: --spp 32
-- The room of data/14demo.lua, path traced: the evening sky comes in at the window, the lamp hangs over the table, and
-- what they do not reach is lit by the walls. No light stands beside the camera.
local room = require 'room'

local eye = { -1.22, 1.42, 2.55 }
local root = room.build { eye = eye, ambient = { 1, 1, 1 } }
local w = room.window
local lights = {
    -- what the sky sends through the window, and the lamp
    gr.area_light { corner = room.place { w.x0 + .1, w.y0 + .1, room.back + .06 }, v1 = room.place { w.x1 - w.x0 - .2, 0, 0 },
        v2 = room.place { 0, w.y1 - w.y0 - .2, 0 }, emission = { 5.2, 3.9, 2.5 }, one_sided = true },
    gr.spherical_light { position = room.place { 0, 1.80, 0 }, radius = .06, emission = { 60, 46, 30 } },
}
gr.render {
    node = root, file = 'dining.png', width = 480, height = 360, integrator = 'path', spp = 512, denoise = true,
    eye = room.place(eye), view = room.place { .49, -.155, -1 }, fov = 43, lights = lights, tone = 'filmic',
    background = gr.sky_cross { image = '../textures/sky_dusk.png' },
}
