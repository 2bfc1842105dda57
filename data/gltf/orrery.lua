-- TITLE: A clockwork of planets that goes to Blender and comes back
-- An animation: planets turn about their sun by gr.frames, as nodes in nodes. Blender paints the outer planet and gives it a
-- moon, gray renders the frames of what Blender writes:
--   gray orrery.lua -o orrery.glb
--   blender -b --python orrery.py -- orrery.glb orrery-back.glb
--   gray orrery-back.glb --frames 1-24 -o orrery.gif
-- Author: gray project

local function metal(r, g, b) return gr.openpbr_material{base_color = {r, g, b}, base_metalness = 1, specular_roughness = 0.3} end
local function paint(r, g, b) return gr.openpbr_material{base_color = {r, g, b}, specular_roughness = 0.4, coat_weight = 0.5} end
local brass = metal(0.9, 0.7, 0.35)

local arms = {}
local function planet(name, distance, radius, height, material)
    arms[name] = gr.node{name = name .. ' arm', children = {
        gr.cylinder{from = {0, height, 0}, to = {distance, height, 0}, radius = 0.04, material = brass},
        gr.cylinder{from = {distance, height, 0}, to = {distance, 1.5, 0}, radius = 0.04, material = brass},
        gr.sphere{name = name, centre = {distance, 1.5, 0}, radius = radius, material = material}}}
    return arms[name]
end

local scene = gr.node{name = 'orrery', children = {
    gr.cylinder{name = 'base', from = {0, 0, 0}, to = {0, 0.2, 0}, radius = 1.2, material = paint(0.2, 0.08, 0.05)},
    gr.cylinder{name = 'axle', from = {0, 0.2, 0}, to = {0, 1.5, 0}, radius = 0.08, material = brass},
    gr.sphere{name = 'sun', centre = {0, 1.5, 0}, radius = 0.45, material = metal(1, 0.8, 0.3)},
    planet('inner', 1.2, 0.16, 0.9, paint(0.7, 0.4, 0.25)),
    planet('middle', 2, 0.25, 0.7, paint(0.2, 0.4, 0.8)),
    planet('outer', 3, 0.3, 0.5, paint(0.8, 0.25, 0.15)),
    gr.disc{name = 'floor', radius = 8, normal = {0, 1, 0}, material = paint(0.5, 0.5, 0.52)}}}

gr.frames{count = 24, fps = 24, loop = true, draw = function(t)
    for name, turns in pairs{inner = 3, middle = 2, outer = 1} do
        arms[name]:reset()
        arms[name]:rotate('y', 360 * turns * t)
    end
    return {node = scene, width = 480, height = 300, eye = {0, 5, 9}, view = {0, -0.45, -1}, fov = 38, colour = 'linear',
            integrator = 'path', spp = 32, denoise = true,
            lights = {gr.light{position = {3, 7, 4}, colour = {1, 1, 1}, intensity = 70},
                      gr.directional_light{direction = {1, -1, -0.5}, colour = {0.4, 0.45, 0.55}}}}
end}
