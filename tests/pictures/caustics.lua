-- TITLE: Light through glass and off mirrors
-- OPTIONS: --default caustics=20000
-- Covers photon maps by --default and by the field with photons and radius, from points, spots, directions and surfaces,
-- through glass (Fresnel, absorption, rough), off mirrors, a metal ring and solids, onto walls, images and bump maps,
-- and in fog.
-- Author: gray project

local textures = '../../textures/'
local glass = gr.difresnel_material(gr.rr_material({ 0, 0, 0 }, { 1, 1, 1 }, 100, 1, 1, 1.5))
local rose = gr.difresnel_material(gr.rr_material { kd = { 0, 0, 0 }, ks = { 1, 1, 1 }, shininess = 100, reflect = 1,
    refract = 1, ior = 1.6, absorption = { .1, .8, .5 } })
local rough = gr.difresnel_material(gr.rr_material { kd = { 0, 0, 0 }, ks = { 1, 1, 1 }, shininess = 100, reflect = 1,
    refract = 1, ior = 1.4, roughness = .1,
    glossy_samples = 1 })
local metal = gr.rr_material({ .1, .08, .02 }, { .95, .8, .4 }, 60, .9, 0, 1)

local function scene(floor)
    local root = gr.node 'scene'
    root:add_child(gr.rectangle { corner = { -5, 0, 5 }, along = { 10, 0, 0 }, up = { 0, 0, -9 }, material = floor })
    root:add_child(gr.rectangle { corner = { -5, 0, -4 }, along = { 10, 0, 0 }, up = { 0, 6, 0 }, material = gr.material({ .7,
        .72, .75 }, { 0, 0, 0 }, 1) })
    root:add_child(gr.sphere { centre = { -1.8, 1.2, 0 }, radius = .8, material = glass })
    root:add_child(gr.difference('lens', gr.cylinder { from = { .3, .6, 1 }, to = { .3, 1.5, 1 }, radius = .6,
        material = rose },
        gr.sphere { centre = { .3, 1.9, 1 }, radius = .7, material = glass }))
    root:add_child(gr.cylinder { from = { 2, 0, .8 }, to = { 2, .8, .8 }, radius = .9, open = true, material = metal })
    root:add_child(gr.sphere { centre = { .2, 1, -1.7 }, radius = .7, material = rough })
    root:add_child(gr.box(gr.rr_material({ 0, 0, 0 }, { .9, .9, .9 }, 100, .9, 0, 1), { -4.6, 0, -2 }, { -4.5, 3, 1.5 }))
    return root
end

local matt = gr.material({ .7, .7, .7 }, { 0, 0, 0 }, 1)
local function picture(name, floor, lights, fields)
    fields = fields or {}
    fields.node, fields.file, fields.width, fields.height = scene(floor), 'caustics-' .. name .. '.png', 96, 72
    fields.eye, fields.target, fields.fov, fields.ambient, fields.lights = { 0, 4, 8.5 }, { -.2, .8, 0 }, 40, { .08, .08,
        .08 }, lights
    gr.render(fields)
end

picture('point', matt, { gr.light({ 1.5, 6, 2.5 }, { .9, .9, .85 }) })
picture('cone', gr.image_material { material = matt, image = textures .. 'checker.png', tiles = 3 },
    { gr.spot_light { position = { -4, 5, 3 }, target = { 0, 0, 0 }, outer = 35, colour = { .5, .9, .9 }, intensity = 40 },
        gr.directional_light({ .6, -1, -.5 }, { .4, .3, .2 }) }, { caustics = 10000 })
picture('surface', gr.bump_material(matt, textures .. 'bricks_height.png', .3), {
    gr.area_light { corner = { 2, 5, 2 }, v1 = { .5, 0, 0 }, v2 = { 0, 0, .5 }, colour = { .5, .5, .6 }, visible = true },
    gr.spherical_light { position = { -3, 4, 2 }, radius = .3, emission = { 14, 10, 6 } },
    gr.disc_light { position = { 0, 5, 0 }, normal = { 0, -1, 0 }, radius = .4, emission = { 5, 5, 5 }, one_sided = true },
}, { caustics = { photons = 15000, radius = .2 }, fog = gr.uniform_fog(.03) })
picture('none', matt, { gr.light({ 1.5, 6, 2.5 }, { .9, .9, .85 }) }, { caustics = 0, refract_limit = 6 })
local sky = gr.clear_sky { sun = { -.4, .6, .3 }, intensity = .4 }
picture('sky', gr.marble_pnd_material(matt, 1, 5, 2, 1, { .3, .3, .5 }), { gr.sky_light { sky = sky, samples = 2 },
    gr.sun_light({ -.4, .6, .3 }, { .6, .55, .45 }),
    gr.mesh_light(gr.mesh { verts = { { 3, 3, 0 }, { 4, 3, 0 }, { 3.5, 3, 1 } }, faces = { { 0, 1, 2 } } }, { 5, 2, 2 }) },
        { caustics = { photons = 8000 }, background = sky })
