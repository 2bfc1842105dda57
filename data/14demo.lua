-- TITLE: Final scene, revised
-- The room again, nearer the table: crystal, a tumbler, oranges in a bowl, a brass knot in the corner; the mirror shows
-- the objects on the wall beside the camera.
-- Author: gray project

local room = require 'room'
local lathe = require 'lathe'
local sweep = require 'sweep'
local knot = require 'knot'

local place = room.place

local function extras(root, m, make)
    local top = room.table_height - .0004

    -- a crystal ball on a brass ring
    local ring = {}
    for i = 1, 40 do
        local a = 2 * math.pi * i / 40
        ring[i] = { .038 * math.cos(a), 0, .038 * math.sin(a) }
    end
    local stand = make.smooth('ring', m.brass, { sweep.tube(ring, .008, 14, { closed = true }) })
    stand:translate(-.20, top + .008, .55)
    root:add_child(stand)
    root:add_child(make.ball('crystal', m.crystal, { -.20, top + .0745, .55 }, .068))

    -- a tumbler: outside up, inside down
    local glass = make.turned('tumbler', m.crystal, lathe.spline({ { 0, 0 }, { .028, 0 }, { .031, .004 }, { .037, .100 },
        { .0365, .102 }, { .0355, .101 }, { .0295, .012 }, { .024, .009 }, { 0, .009 } }, 5), 72)
    glass:translate(.02, top, .42)
    root:add_child(glass)

    -- a bowl of oranges
    local bowl = make.turned('bowl', m.glaze, lathe.spline({ { 0, .004 }, { .045, .004 }, { .048, 0 }, { .054, .004 }, { .060, .012 },
        { .115, .040 }, { .148, .085 }, { .150, .088 }, { .146, .087 }, { .110, .048 }, { .050, .020 }, { 0, .018 } }, 6), 96)
    bowl:translate(.44, top, .24)
    root:add_child(bowl)
    for _, p in ipairs { { -.052, .060, .030 }, { .050, .060, .034 }, { .002, .062, -.058 }, { .004, .118, .004 } } do
        root:add_child(make.ball('orange', m.orange, { .44 + p[1], top + p[2], .24 + p[3] }, .044))
    end

    -- a knot on a pedestal in the corner
    root:add_child(make.box('pedestal', m.oak_dark, { 2.20, -.001, -1.98 }, { 2.54, .86, -1.64 }))
    root:add_child(make.box('plate', m.oak_dark, { 2.17, .8599, -2.01 }, { 2.57, .90, -1.61 }))
    local sculpture = make.smooth('knot', m.brass, { knot.mesh(2, 3, { n = 300, around = 24, radius = .17 }) })
    sculpture:rotate('x', 80)
    sculpture:rotate('y', -25)
    sculpture:scale(.155, .155, .155)
    sculpture:translate(2.37, 1.135, -1.81)
    root:add_child(sculpture)

    -- a globe on a bracket; only the mirror sees it
    root:add_child(make.box('bracket', m.oak_dark, { 2.62, 1.36, -.22 }, { room.right + .01, 1.40, .42 }))
    root:add_child(make.box('stem', m.brass, { 2.748, 1.39, .092 }, { 2.772, 1.46, .116 }))
    local globe = gr.geometry('globe', gr.sphere(gr.td_sphere_material {
        material = gr.material({ .6, .6, .6 }, { .3, .3, .3 }, 60), png = '../textures/earth.png', flip_u = true,
    }))
    globe:rotate('y', 60)
    globe:rotate('z', 23)
    globe:scale(.125, .125, .125)
    globe:translate(2.76, 1.575, .104)
    root:add_child(globe)
end

local eye = { -1.22, 1.42, 2.55 }
local root, lights = room.build { eye = eye, extras = extras }

gr.render_skybox {
    node = root, file = '14demo.png', sky = '../textures/sky_dusk.png', width = 1280, height = 960,
    eye = place(eye), view = place { .49, -.155, -1 }, fov = 43,
    ambient = room.ambient, lights = lights, refract_limit = 6,
    side_tolerance = .015, corner_tolerance = .025,
}
