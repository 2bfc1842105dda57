-- TITLE: Cameras, sampling and tones
-- Covers every field of gr.render that shapes a picture: view and target, projections, angle, view_height, shifts, lens with
-- blades, focus and focus_point, shutter, moving eye, view, target and up, node:velocity and node:moves_to, stereo with
-- eye_distance and screen, samples, full, tolerances, area_samples, limits, seed, accel, exposure, tone, srgb, deep;
-- node:render.
-- Author: gray project

local function scene()
    local root = gr.node 'scene'
    root:add_child(gr.plane { normal = { 0, 1, 0 }, material = gr.image_material { tiles = .5,
        image = '../../textures/checker.png',
        material = gr.rr_material({ .8, .8, .8 }, { .4, .4, .4 }, 30, .2, 0, 1) } })
    for k = 0, 6 do
        local material = k % 3 == 0 and gr.rr_material({ .1, .1, .1 }, { .9, .9, .9 }, 100, .8, 0, 1) or
            gr.material({ .3 + .1 * k, .7 - .1 * k, .4 }, { .5, .5, .5 }, 40)
        root:add_child(gr.sphere { material = material, centre = { 1.4 * (k - 3), .7, 2 - 1.3 * k }, radius = .7 })
    end
    root:add_child(gr.nh_box(gr.material({ .9, .8, .3 }, { .2, .2, .2 }, 10), { -1, 0, -7 }, { 2, 3, 2 }))
    return root
end

local number = 0
local function picture(fields, root)
    number = number + 1
    fields.node, fields.file, fields.width, fields.height = root or scene(), ('cameras-%02d.png'):format(number), 96, 72
    fields.eye, fields.ambient, fields.background = fields.eye or { 0, 1.6, 7 }, { .25, .25, .25 }, { .4, .55, .8 }
    fields.lights = { gr.light({ -6, 8, 6 }, { .6, .6, .55 }), gr.area_light({ 3, 6, 4 }, { 2, 0, 0 }, { 0, 0, 2 }, { .3, .3,
        .3 }, { 1, 0, 0 }) }
    gr.render(fields)
end

-- lenses and motion: what rolls, what turns, what is in a group that moves, an eye that turns
picture { target = { 0, .7, 0 }, fov = 50, aperture = .25, focus_point = { -1.4, .7, -.6 }, blades = 5, blade_angle = 20,
    samples = 3, seed = 7 }
local root = scene()
local function moved(node, x, y, z)
    node:translate(x, y, z)
    return node
end
root:add_child(moved(gr.sphere { radius = .5, material = gr.material({ 1, .3, .3 }, { .5, .5, .5 }, 40) }, -2, 2.5,
    0):velocity(1.2, 0, 0))
local cube = moved(gr.cube(gr.marble_pnd_material(gr.material({ .9, .9, .9 }, { 0, 0, 0 }, 1), 2, 5, 6, 1, { .1, .1, .4 })), 1,
    2, 0)
cube:moves_to(gr.node 'there':rotate('z', 40):scale(1, 1.3, 1):translate(1.8, 2.2, 0))
local group = gr.node { children = { cube, gr.torus { major = .5, minor = .15, material = gr.material({ .2, .8, .3 }, { .5, .5,
    .5 }, 40) }:translate(0, 3, 0) } }
group:velocity { 0, .4, 0 }
root:add_child(group)
local silver = gr.material({ .6, .6, .65 }, { .5, .5, .5 }, 40)
root:add_child(gr.instances { of = gr.difference('bitten', gr.sphere { radius = .4, material = silver },
    gr.sphere { centre = { .3, .3, .3 }, radius = .3, material = silver }):velocity(0, .5, 0),
    at = { { -3, 2.6, 0 }, { 3, 2.6, 0 } } })
picture({ target = { 0, 1.4, 0 }, fov = 46, shutter = { .2, 1.1 }, eye_to = { .1, 1.6, 7 }, target_to = { .05, 1.4, 0 },
    up_to = { .03, 1, 0 }, samples = 4, full = true }, root)

-- projections: parallel from the side with a shifted window, all around, a circle, in two eyes
picture { projection = 'orthographic', view = { -.4, -.5, -1 }, eye = { 3, 4, 8 }, view_height = 7, shift_x = .1,
    shift_y = -.2, tone = 'filmic', exposure = .5, accel = 'kdtree' }
picture { projection = 'panorama', eye = { 0, 2, 3 }, view = { 0, -.1, -1 }, up = { .2, 1, 0 }, srgb = true, shift_x = .2 }
picture { target = { 0, .7, 0 }, fov = 55, stereo = 'anaglyph', eye_distance = .2, screen = 5 }
picture { projection = 'fisheye', angle = 250, eye = { 0, 1.4, 3 }, tone = 'reinhard', exposure = 2, view_to = { .1, 0, -1 },
    side_tolerance = 0, corner_tolerance = 0, samples = 2,
    accel = 'none', shift_y = .1 }
scene():render { file = 'cameras-07.png', width = 96, height = 72, eye = { -1, 2, 7 }, target = { 0, 1, 0 }, target_to = { 0,
    1.1, 0 }, fov = 55, stereo = 'side', shift_y = .1, ambient = { .4, .4, .4 },
    reflect_limit = 0, refract_limit = 0, area_samples = 3, full = false, samples = 5, aperture = .1, focus = 7, blades = 3,
        deep = true, srgb = true, accel = 'bvh', specular = 'blinn',
    lights = { gr.spherical_light { position = { 4, 6, 5 }, radius = 1, colour = { .6, .6, .6 } } }, cutoff = 0,
        caustics = { photons = 3000 } }
