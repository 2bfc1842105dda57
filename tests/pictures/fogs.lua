-- TITLE: Fogs of every kind
-- Covers gr.uniform_fog (also squared), gr.linear_fog, gr.height_fog, gr.fog_profile and gr.fog_grid, with clear_sky and
-- without, before and behind mirrors and glass, inside of solids and glass, with lights that are visible, an eye inside and
-- outside of the fog, and an orthographic picture.
-- Author: gray project

local function scene()
    local root = gr.node 'scene'
    root:add_child(gr.plane { normal = { 0, 1, 0 }, material = gr.image_material { tiles = .25,
        image = '../../textures/checker.png',
        material = gr.material({ .8, .8, .8 }, { 0, 0, 0 }, 1) } })
    for k = 0, 5 do
        local pillar = gr.cylinder { from = { 2 * (k % 2) - 1.8 - .3 * k, 0, -3 * k }, to = { 2 * (k % 2) - 1.8 - .3 * k, 3,
            -3 * k }, radius = .35,
            material = gr.material({ .9, .3 + .1 * k, .2 }, { .3, .3, .3 }, 20) }
        root:add_child(pillar)
    end
    root:add_child(gr.rectangle { corner = { 1.4, .1, -3 }, along = { 1.6, 0, 1.4 }, up = { 0, 2.6, 0 },
        material = gr.rr_material({ 0, 0, 0 }, { .9, .9, .9 }, 100, .95, 0, 1) })
    root:add_child(gr.sphere { centre = { .4, .9, 1 }, radius = .9, material = gr.difresnel_material(gr.rr_material({ 0, 0,
        0 }, { 1, 1, 1 }, 100, 1, 1, 1.5)) })
    root:add_child(gr.difference('cut', gr.box(gr.material({ .3, .5, .8 }, { 0, 0, 0 }, 1), { -3.4, 0, 0 }, { -1.8, 1.5, 1.6 }),
        gr.sphere { centre = { -2, 1.3, 1.4 }, radius = .9, material = gr.rr_material({ .2, .2, .2 }, { .8, .8, .8 }, 50, .6,
            0, 1) }))
    return root
end

local function picture(name, fog, fields)
    fields = fields or {}
    fields.node, fields.file, fields.width, fields.height, fields.fog = scene(), 'fogs-' .. name .. '.png', 96, 72, fog
    fields.eye, fields.target, fields.fov = fields.eye or { .5, 1.8, 7 }, { -.2, 1.2, 0 }, 42
    fields.ambient = { .25, .25, .25 }
    fields.background = fields.background or gr.sky_gradient { { -.1, .9, .7, .5 }, { .4, .2, .3, .8 } }
    fields.lights = { gr.light({ -5, 8, 6 }, { .7, .7, .65 }), gr.spherical_light { position = { 1.5, 3, -4 }, radius = .4,
        colour = { .3, .3, .2 }, visible = true } }
    gr.render(fields)
end

picture('uniform', gr.uniform_fog(.06, { .7, .7, .75 }))
picture('squared', gr.uniform_fog { density = .12, squared = true, colour = { .8, .6, .4 }, clear_sky = true })
picture('linear', gr.linear_fog { near = 5, far = 18, colour = { .3, .5, .4 }, clear_sky = true },
    { projection = 'orthographic', view_height = 6 })
picture('height', gr.height_fog { density = .6, base = .2, scale = .5, colour = { .8, .8, .9 } }, { background = 'gradient',
    eye = { 1, .8, 5 } })
picture('profile', gr.fog_profile { profile = { { 0, .01 }, { .8, .5 }, { 1, 0 }, { 2, .1 }, { 3, 0 } }, colour = { .9, .9,
    .8 }, clear_sky = true })
local densities = {}
for k = 1, 6 * 4 * 8 do densities[k] = (k * 37) % 5 == 0 and .8 or 0 end
picture('grid', gr.fog_grid { corner = { -4, 0, -9 }, size = { 7, 2.5, 13 }, cells = { 6, 4, 8 }, densities = densities,
    colour = { .95, .9, 1 } },
    { background = { .2, .25, .4 } })
