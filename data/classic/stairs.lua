-- TITLE: Winding stair
-- Steps around a column of marble, with a glass ball on the newel and a mirror floor.
-- Author: gray project. Dialect: project.

local sweep = require 'sweep'

local root = gr.node('stair')
local marble = gr.marble_pnd_material(gr.rr_material({ .85, .83, .8 }, { .4, .4, .4 }, 60, .1, 0, 1), .9, 5, 5, 1, { .45, .42, .42 })
local wood = gr.wood_pnd_material(gr.material({ .55, .35, .2 }, { .2, .2, .2 }, 20), .8, 9, 1, { .35, .2, .1 })
local brass = gr.rr_material({ .5, .36, .14 }, { .7, .55, .3 }, 50, .25, 0, 1)
local glass = gr.difresnel_material(gr.rr_material({ 0, 0, 0 }, { .97, .98, .98 }, 200, 0, 1, 1.5))
local floor = gr.rr_material({ .25, .27, .30 }, { .5, .5, .5 }, 80, .5, 0, 1)

local ground = gr.geometry('floor', gr.cube(floor))
ground:scale(30, 1, 30)
ground:translate(-15, -1, -15)
root:add_child(ground)

local column = gr.geometry('column', gr.cube(marble))
column:translate(-.5, 0, -.5)
column:rotate('y', 12)
column:scale(.7, 6, .7)
root:add_child(column)

local step = gr.geometry('step', gr.cube(wood))
step:scale(2.2, .09, .62)
step:translate(.25, 0, -.31)
local post = gr.geometry('post', gr.cube(brass))
post:scale(.03, .8, .03)
post:translate(2.3, .08, 0)
local one = gr.node('one')
one:add_child(step)
one:add_child(post)
local rail = {}
for k = 0, 19 do
    local at = gr.node('step ' .. k)
    at:rotate('y', 20 * k)
    at:translate(0, .25 * k + .2, 0)
    at:add_child(one)
    root:add_child(at)
end
for i = 0, 120 do
    local t = 19 * i / 120
    local a = -math.rad(20 * t)
    rail[i + 1] = { 2.315 * math.cos(a), .25 * t + 1.08, 2.315 * math.sin(a) }
end
root:add_child(gr.geometry('rail', gr.vn_mesh(brass, sweep.tube(rail, .05, 14))))

local ball = gr.geometry('ball', gr.sphere(glass))
ball:scale(.32, .32, .32)
ball:translate(2.3, 1.42, 0)
root:add_child(ball)

gr.render {
    node = root, file = 'stairs.png', width = 320, height = 480, eye = { 4.5, 4.2, 8.5 }, view = { -.5, -.17, -1 }, fov = 46,
    ambient = { .28, .28, .30 }, background = { .55, .62, .70 },
    lights = { gr.light({ 7, 9, 8 }, { .65, .62, .55 }, { 1, 0, 0 }), gr.light({ -6, 6, 6 }, { .3, .3, .36 }, { 1, 0, 0 }) },
}
