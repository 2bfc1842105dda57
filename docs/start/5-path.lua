local things = require 'things'

local lamp = gr.area_light{corner = {-4, 5, 1}, v1 = {2, 0, 0}, v2 = {0, 0, 2}, emission = {24, 22, 20}}

gr.render{
    node = things.all, width = 640, height = 400,
    eye = {0, 4.6, 6}, target = {0, 0.6, 0}, fov = 34,
    background = {0.2, 0.23, 0.28}, lights = {lamp},
    integrator = 'path', spp = 64, denoise = true,
}
