-- TITLE: Skies and backgrounds
-- Covers gr.render_skybox with a cross that is mirrored and one that is not, gr.sky_cross, gr.sky_faces, gr.sky_map (PNG,
-- HDR, PFM and EXR), gr.sky_gradient, gr.clear_sky by a direction and by time and place, the background 'gradient' and a
-- colour, intensity and rotation; each seen as it is, in a mirror and through glass, and most as a gr.sky_light.
-- Author: gray project

local textures = '../../textures/'
local light = '../fuzz/corpus/light/'

local function scene()
    local root = gr.node 'scene'
    root:add_child(gr.cylinder { from = { 0, -1.2, 0 }, to = { 0, -1, 0 }, radius = 3, material = gr.material { kd = { .7, .7,
        .7 } } })
    root:add_child(gr.sphere { centre = { -1.2, 0, 0 }, material = gr.rr_material({ .02, .02, .02 }, { .95, .95, .95 }, 200,
        .9, 0, 1) })
    root:add_child(gr.sphere { centre = { 1.1, -.3, .8 }, radius = .7,
        material = gr.difresnel_material(gr.rr_material({ 0, 0, 0 }, { 1, 1, 1 }, 200, 1, 1, 1.5)) })
    root:add_child(gr.sphere { centre = { .6, -.4, -1.2 }, radius = .6, material = gr.material({ .8, .8, .8 }, { .1, .1, .1 },
        20) })
    return root
end

local function picture(name, background, fields)
    fields = fields or {}
    fields.node, fields.file, fields.width, fields.height = fields.node or scene(), 'skies-' .. name .. '.png', 96, 72
    fields.eye, fields.target, fields.fov = fields.eye or { 0, .6, 6 }, fields.target or { 0, -.1, 0 }, fields.fov or 60
    fields.ambient, fields.background = fields.ambient or { .1, .1, .1 }, background
    gr.render(fields)
end

-- a cross, by the old function and as a sky; the letters are readable or mirrored
gr.render_skybox(scene(), 'skies-cross.png', textures .. 'sky_letters.png', 96, 72, { 0, .6, 6 }, { .3, .1, -1 }, { 0, 1, 0 },
    80,
    { .3, .3, .3 }, { gr.light({ 3, 5, 6 }, { .6, .6, .6 }) })
gr.render_skybox { node = scene(), file = 'skies-mirrored.png', sky = textures .. 'sky_letters.png', mirror = true, width = 96,
    height = 72,
    eye = { 0, .6, 6 }, projection = 'panorama', ambient = { .4, .4, .4 } }

-- six pictures, turned, all around
local names = { front = 'checker', right = 'tiles', back = 'panel', left = 'bricks_height', top = 'label',
    bottom = 'leaves_mask' }
local faces = { rotation = 30, intensity = .8 }
for side, name in pairs(names) do faces[side] = textures .. name .. '.png' end
faces.top = gr.texture { file = faces.top, filter = 'nearest', flip_u = true }
local six = gr.sky_faces(faces)
local both = gr.node 'both'
both:add_child(scene())
picture('faces', six, { node = both, projection = 'panorama', eye = { 0, .3, 2.4 }, lights = { gr.sky_light(six) } })

-- maps: one is visible, others light one ball each
local root = scene()
local balls, lights = {}, {}
local pfm = gr.sky_map { image = light .. 'picture.pfm', intensity = 1.5 }
local has_exr, exr = pcall(gr.sky_map, { image = light .. 'picture.exr', rotation = 90, intensity = 1.5 })
local maps = { pfm, has_exr and exr or pfm, gr.sky_map(textures .. 'earth.png'),
    gr.sky_cross { image = textures .. 'sky_dusk.png', rotation = -60 },
    gr.sky_cross { image = textures .. 'sky_letters.png', mirror = true, intensity = 1.5 } }
for k, map in ipairs(maps) do
    balls[k] = gr.sphere { centre = { k - 3, 1.6, 0 }, radius = .45, material = gr.material { kd = { .8, .8, .8 } } }
    root:add_child(balls[k])
    lights[k] = gr.sky_light { sky = map, include = { balls[k] }, samples = 3 }
end
local map = gr.sky_map { image = light .. 'picture.hdr', rotation = 120, intensity = 1 }
lights[#lights + 1] = gr.sky_light { sky = map, exclude = balls }
picture('map', map, { node = root, lights = lights, fov = 70 })

-- the clear sky, in the evening by the clock, with its sun
local function evening(fields)
    for name, value in pairs { hour = 18.5, day = 100, latitude = 52, longitude = 13, zone = 1 } do fields[name] = value end
    return fields
end
local clear = gr.clear_sky(evening { turbidity = 4, ground = { .2, .25, .1 }, intensity = 1 })
picture('clear', clear, { lights = { gr.sky_light(clear), gr.sun_light(evening { colour = { .5, .4, .3 } }) },
    projection = 'fisheye', angle = 220, eye = { 0, .3, 3 } })

-- gradients, with glass; another sky as light
local noon = gr.clear_sky({ .3, .8, -.5 }, 2.2)
picture('gradient', 'gradient', { fov = 70, lights = {
    gr.sky_light 'gradient',
    gr.sky_light { sky = gr.sky_gradient { stops = { { -.5, .5, .1, 0 }, { .5, 0, .4, .1 } }, rotation = 10, intensity = .6 } },
    gr.sky_light { sky = noon, colour = { .2, .2, .2 }, samples = 1 },
} })
