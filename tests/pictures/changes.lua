-- TITLE: Changes as a window writes them, and orders of transforms
-- Covers gr.change_node, gr.change_add, gr.change_delete, gr.change_material, gr.change_look (every part), gr.change_own,
-- gr.change_light, gr.change_delete_light, gr.change_add_light, gr.change_copy_light, gr.change_view and
-- gr.change_exposure, and gr.transform_order with each of its orders.
-- Author: gray project

-- Nodes and materials are numbered from the start of the script: the objects of the changes come first.
local first = gr.material({ .7, .2, .2 }, { .4, .4, .4 }, 20) -- 1
local second = gr.material({ .2, .6, .3 }, { .4, .4, .4 }, 20) -- 2
local glass = gr.difresnel_material(gr.rr_material({ 0, 0, 0 }, { 1, 1, 1 }, 100, 1, 1, 1.5)) -- 4, over 3
local marble = gr.marble_pnd_material(gr.rr_material({ .7, .7, .7 }, { .5, .5, .5 }, 40, .2, 0, 1), 2, 6, 5, 1, { .2, .1,
    .1 }) -- 6, over 5

local root = gr.node 'root' -- 0
local balls = {} -- 1 to 5
for k, material in ipairs { first, second, glass, marble, first } do
    balls[k] = gr.sphere { name = 'ball', material = material, centre = { 2 * k - 6, .9, 0 }, radius = .9 }
    root:add_child(balls[k])
end
root:add_child(gr.plane { name = 'floor', normal = { 0, 1, 0 }, material = gr.material({ .7, .7, .65 }, { .2, .2, .2 },
    10) }) -- 6
local sky = gr.sky_cross '../../textures/sky_dusk.png'

local function picture(name, node)
    gr.render {
        node = node or root, file = 'changes-' .. name .. '.png', width = 96, height = 72, eye = { 0, 3, 9 }, target = { 0, 1,
            0 }, fov = 44,
        ambient = { .15, .15, .15 }, background = { .4, .5, .7 }, lights = {
            gr.light({ -4, 5, 5 }, { .5, .45, .4 }), gr.area_light({ 3, 5, 0 }, { 1.5, 0, 0 }, { 0, 0, 1.5 }, { .3, .3, .3 },
                { 1, 0, 0 }),
            gr.spot_light { position = { 0, 6, 3 }, target = { 0, 0, 0 }, outer = 25, colour = { .3, .4, .2 } },
            gr.sky_light { sky = sky, colour = { .3, .3, .3 } },
        },
    }
end

picture 'before'

gr.change_node('ball', 1, { 1, 0, 0, .3, 0, 1.4, 0, .6, 0, .2, 1, .5 })
gr.change_delete('ball', 5)
gr.change_own('ball', 2)
gr.change_material(2147483647, { .9, .8, .1 })
gr.change_add('root', 0, 'torus', { .3, .3, .9 })
gr.change_add('root', 0, 'copy', { 1, 1, 1 }, 4)
gr.change_add('root', 0, 'cone')
gr.change_add('root', 0, 'cylinder', { .9, .9, .9 })
gr.change_add('root', 0, 'cube', { .2, .8, .8 })
gr.change_add('root', 0, 'sphere', { .8, .4, .8 })
for k, name in ipairs { 'torus', 'copy', 'cone', 'cylinder', 'cube', 'sphere' } do
    local x, y, z = -4 + 1.4 * k, name == 'copy' and 1.5 or 2.7, name == 'copy' and -1 or -1.5
    gr.change_node(name, 4294967296 - k, { .6, 0, 0, x, 0, .6, .1, y, 0, -.1, .6, z })
end
picture 'nodes'

for _, look in ipairs {
    { 'kd', { .2, .3, .1 } }, { 'ks', { .9, .8, .6 } }, { 'shininess', 90 }, { 'reflect', .7 }, { 'roughness', .15 },
        { 'emission', { .1, 0, .05 } },
} do
    gr.change_look(1, look[1], look[2])
end
gr.change_look(3, 'ior', 1.2)
gr.change_look(3, 'absorption', { .1, .6, 1 })
gr.change_look(3, 'refract', .9)
gr.change_material(5, { .3, .4, .9 })
picture 'materials'

gr.change_light(1, { 3, 0, 1 }, { 1, .6, .4 })
gr.change_light(2, { -2, 0, 1 }, { 1.5, 1.5, 1.5 }, { 2, 0, 0, 0, 1, 0, 0, .3, 1 }, { .2, .3, .6 })
gr.change_copy_light(3, { -3, 0, 1 }, { 2, 1, 3 })
gr.change_light(4, { 0, 0, 0 }, { .8, 1.2, .8 }, { 0, 0, 1, 0, 1, 0, -1, 0, 0 })
gr.change_add_light({ 4, 1, 4 }, { .4, .1, .1 })
gr.change_delete_light(3)
gr.change_view('changes-lights.png', { 2, 2.5, 8 }, { -.2, -.2, -1 }, { .1, 1, 0 }, 50)
gr.change_exposure('changes-lights.png', -.7)
picture 'lights'

-- the same calls in three orders, in the fifth picture
local all = gr.node 'all'
for k, order in ipairs { 'new', 'old', 'separate' } do
    gr.transform_order(order)
    local inner = gr.cone { material = first, radius = .6 }
    inner:translate(.5, .4, 0):scale(1, 1.5, .5):rotate('z', 40)
    local outer = gr.node { children = { inner, gr.cube(second):scale(.5, .5, .5):translate(.3, -.6, .2):rotate('y', 30) } }
    outer:rotate('y', 20):scale(1.2, 1, 1):rotate_axis({ 1, 1, 0 }, 15):translate(0, .4, 0):rotate_quat(.9, 0, .2, .1)
    gr.transform_order 'new'
    local place = gr.node { children = { outer } }
    place:translate(3 * k - 6, .8, 0)
    all:add_child(place)
end
picture('orders', all)
