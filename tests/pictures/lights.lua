-- TITLE: Lights of every kind
-- Covers gr.light, gr.spot_light, gr.directional_light, gr.sun_light, gr.area_light, gr.spherical_light, gr.disc_light,
-- gr.mesh_light and gr.sky_light, with every field: falloff, range, intensity, emission, samples, visible, one_sided,
-- include and exclude; lights below nodes that are instances; surfaces in front of, behind and inside lights.
-- Author: gray project

local function matt(kd) return gr.material(kd, { .3, .3, .3 }, 20) end

--- A floor, a wall and five balls; returns the root and its objects by name.
local function room()
    local parts = {
        root = gr.node 'room',
        floor = gr.plane { normal = { 0, 1, 0 }, material = matt { .7, .7, .7 } },
        wall = gr.plane { normal = { 0, 0, 1 }, distance = -4, material = matt { .6, .65, .7 } },
        balls = {},
    }
    parts.root:add_child(parts.floor)
    parts.root:add_child(parts.wall)
    for k = -2, 2 do
        local ball = gr.sphere { centre = { 1.7 * k, .7, -.6 * (k % 2) }, radius = .7, material = matt { .8, .5 + .15 * k,
            .4 } }
        parts.balls[k + 3] = ball
        parts.root:add_child(ball)
    end
    -- a mirror shows visible lights
    parts.root:add_child(gr.box { min = { -4.4, 0, -3.9 }, max = { -1.2, 2.6, -3.8 },
        material = gr.rr_material({ 0, 0, 0 }, { .9, .9, .9 }, 100, .9, 0, 1) })
    return parts
end

local function picture(name, root, lights, background, tone)
    gr.render {
        node = root, file = 'lights-' .. name .. '.png', width = 96, height = 72, eye = { 0, 3.2, 9.5 }, target = { 0, 1.2, 0 },
        fov = 36, ambient = { .05, .05, .06 }, background = background or { .1, .1, .15 }, lights = lights,
        tone = tone,
    }
end

-- points and directions
local here = room()
picture('points', here.root, {
    gr.light({ -4, 3, 3 }, { .9, .3, .2 }, { .5, .1, .05 }),
    gr.light { position = { 0, 2.5, 2 }, colour = { .3, .9, .3 }, range = 4, exclude = { here.balls[3] } },
    gr.light { position = { 3.5, 2, 1.5 }, colour = { .3, .3, .9 }, intensity = 4 },
    gr.light { position = { 1.7, .7, -.6 }, colour = { 1, 1, 1 }, intensity = 1, include = { here.wall } },
    gr.directional_light({ 1, -1, -1 }, { .25, .25, .2 }),
    gr.directional_light { direction = { -1, -.6, -.3 }, colour = { .3, .2, 0 }, exclude = { here.wall },
        include = { here.root } },
})

-- cones
here = room()
picture('spots', here.root, {
    gr.spot_light({ -3, 5, 3 }, { 0, -1, -.5 }, { .9, .7, .5 }, 15, 25, { 1, 0, 0 }),
    gr.spot_light { position = { 0, 4, 4 }, target = { 0, .7, 0 }, colour = { .5, .9, .5 }, outer = 12 },
    gr.spot_light { position = { 3, 4, 2 }, target = { 2.6, 0, 0 }, colour = { .5, .5, 1 }, inner = 30, range = 7 },
    gr.spot_light { position = { 4, .4, 3 }, target = { 0, 1.5, -4 }, colour = { 1, .2, .2 }, inner = 0, outer = 20,
        intensity = 30,
        include = { here.wall, here.balls[4] } },
    -- more than half of all directions, and all directions
    gr.spot_light { position = { -4, 1, 1 }, direction = { -1, 0, 0 }, colour = { .4, .3, .5 }, inner = 100, outer = 140 },
    gr.spot_light { position = { 0, 7, 0 }, colour = { .1, .1, .1 }, inner = 180, outer = 180, falloff = { .1, .1, 0 },
        exclude = { here.floor } },
})

-- lights with a surface that have a colour
here = room()
picture('surfaces', here.root, {
    gr.area_light({ -4, 4.2, 0 }, { 1.5, 0, 0 }, { 0, .4, 1 }, { .5, .4, .3 }, { 1, 0, 0 }),
    gr.area_light { corner = { -1, 3.2, -3.5 }, v1 = { 1.4, 0, 0 }, v2 = { 0, .7, 0 }, colour = { .5, .5, .2 }, visible = true,
        samples = 3,
        range = 6 },
    gr.spherical_light({ 3, 3, 2 }, { .3, .2, .5 }, { .5, .1, .01 }, .7),
    gr.spherical_light { position = { 2.6, 2.6, -1 }, radius = .4, colour = { .4, .8, .6 }, intensity = 2, visible = true },
    gr.disc_light({ 0, 5, 3 }, { 0, -1, -.3 }, 1, { .25, .25, .25 }, { 1, 0, 0 }),
    gr.disc_light { position = { -3, 2.9, -1.5 }, normal = { .4, -.2, 1 }, radius = .5, colour = { .8, .3, .3 }, visible = true,
        one_sided = true, samples = 1, exclude = { here.balls[2] } },
})

-- lights with a radiance
here = room()
picture('radiance', here.root, {
    gr.area_light { corner = { -2, 3, -2 }, v1 = { 2, 0, 0 }, v2 = { 0, 0, 1.4 }, emission = { 8, 6, 4 }, visible = true,
        one_sided = true },
    gr.area_light { corner = { 3.9, 0, -2 }, v1 = { 0, 0, 2 }, v2 = { 0, 2, 0 }, emission = { .7, 2, 4 }, visible = true,
        samples = 3 },
    gr.spherical_light { position = { 1.5, 2.7, -.5 }, radius = .5, emission = { 9, 9, 9 }, colour = { 1, .7, .9 },
        visible = true },
    -- a ball inside a light, and a light that cuts the floor
    gr.spherical_light { position = { 1.7, .7, -.6 }, radius = .9, emission = { .5, .1, .1 }, include = { here.balls[4] } },
    gr.spherical_light { position = { -3.4, -.2, 2 }, radius = .5, emission = { 3, 6, 3 }, visible = true },
    gr.disc_light { position = { -.2, .02, 2.3 }, normal = { 0, 1, 0 }, radius = .6, emission = { 4, 2.5, .8 },
        visible = true },
    gr.disc_light { position = { 0, 3, 6 }, normal = { 0, 0, -1 }, radius = 1, emission = { 3, 3, 3 }, one_sided = true,
        samples = 1 },
}, nil, 'reinhard')

-- emitting meshes
here = room()
local verts = { { 0, 0, 0 }, { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } }
local faces = { { 0, 2, 1 }, { 0, 1, 3 }, { 0, 3, 2 }, { 1, 2, 3 } }
local function glow(r, g, b) return gr.material { kd = { .1, .1, .1 }, emission = { r, g, b } } end
local crystal = gr.mesh { verts = verts, faces = faces, materials = { glow(24, 8, 4), glow(4, 24, 4) }, face_materials = { 1,
    1, 2, 2 } }
local twice = gr.instances { of = crystal, at = { { -2.6, 2, .4 }, { 1, 2.2, -1.5 } }, turn = { 20, 140 }, size = { .8, 1.2 } }
here.root:add_child(twice)
local unseen = gr.mesh { verts = { { -1, 0, 0 }, { 1, 0, 0 }, { 1, 0, 1 }, { -1, 0, 1 } }, faces = { { 0, 1, 2, 3 } } }
unseen:translate(2, 4, 1)
local ring = gr.mesh { file = '../../data/models/gear.stl', material = glow(4, 5, 12) }
ring:scale(.4, .4, .4):rotate('x', 60):translate(3.4, 1.6, 1.2)
here.root:add_child(ring)
picture('meshes', here.root, {
    gr.mesh_light { mesh = crystal, samples = 3, exclude = { crystal } },
    gr.mesh_light(unseen, { 4, 4, 4 }),
    gr.mesh_light { mesh = ring, colour = { .7, 1, .7 }, include = { here.floor, here.balls[4], here.balls[5] } },
}, nil, 'reinhard')

-- sun and sky
here = room()
local sky = gr.sky_gradient { { -1, .2, .2, .2 }, { 0, .9, .6, .4 }, { .3, .4, .5, .9 }, { 1, .1, .2, .7 } }
picture('sun', here.root, {
    gr.sun_light({ -.5, .5, .6 }, { .5, .45, .3 }),
    gr.sun_light { hour = 16.5, day = 80, latitude = -33, longitude = 151, zone = 10, colour = { .3, .1, .1 },
        exclude = { here.balls[1] } },
    gr.sky_light { sky = sky, samples = 3, colour = { .7, .7, .7 }, include = { here.floor, table.unpack(here.balls) } },
    gr.sky_light { .1, .15, .2 },
}, sky)
