-- TITLE: A place to walk through
-- A cloister around a pool: `gray -gui data/12demo.lua`, Space, then W A S D, E and Q for up and down, and the mouse.
-- The window shows the picture while it is made, coarse first; pixels that are sampled again are red. V saves the
-- camera. Author: gray project

local stage = require 'stage'

local root = gr.node('cloister')
local stone = gr.material({ .74, .70, .62 }, { .05, .05, .05 }, 10)
local dark = gr.material({ .34, .31, .28 }, { .05, .05, .05 }, 10)
local pale = gr.material({ .62, .58, .52 }, { .05, .05, .05 }, 10)
local water = gr.rr_material({ .03, .09, .10 }, { .9, .9, .9 }, 200, .55, 0, 1)
local brass = gr.rr_material({ .55, .40, .14 }, { .9, .8, .5 }, 80, .25, 0, 1)

root:add_child(stage.checkers('floor', dark, pale, -8, -8, 8, 8, 1))
root:add_child(stage.box('pool', water, { -2.5, -.1, -2.5 }, { 2.5, .06, 2.5 }))
for _, side in ipairs { { -2.8, -2.8, 2.8, -2.5 }, { -2.8, 2.5, 2.8, 2.8 }, { -2.8, -2.5, -2.5, 2.5 }, { 2.5, -2.5, 2.8, 2.5 } } do
    root:add_child(stage.box('rim', stone, { side[1], 0, side[2] }, { side[3], .25, side[4] }))
end

-- One column, shown many times.
local column = gr.node('column')
column:add_child(stage.box('base', stone, { -.32, 0, -.32 }, { .32, .18, .32 }))
local shaft = gr.cylinder('shaft')
shaft:set_material(stone)
shaft:scale(.2, 1.2, .2)
shaft:translate(0, 1.38, 0)
column:add_child(shaft)
column:add_child(stage.box('capital', stone, { -.3, 2.55, -.3 }, { .3, 2.8, .3 }))
for i = -2, 2 do
    for _, place in ipairs { { i * 2, -4.5 }, { i * 2, 4.5 }, { -4.5, i * 2 }, { 4.5, i * 2 } } do
        local copy = gr.node('place')
        copy:add_child(column)
        copy:translate(place[1], 0, place[2])
        root:add_child(copy)
    end
end

-- Roof beams over the walk, and the wall around it.
for _, b in ipairs { { -8, -8, 8, -4.1 }, { -8, 4.1, 8, 8 }, { -8, -4.1, -4.1, 4.1 }, { 4.1, -4.1, 8, 4.1 } } do
    root:add_child(stage.box('roof', stone, { b[1], 2.8, b[2] }, { b[3], 3.1, b[4] }))
end
for _, b in ipairs { { -8.3, -8.3, 8.3, -8 }, { -8.3, 8, 8.3, 8.3 }, { -8.3, -8, -8, 8 }, { 8, -8, 8.3, 8 } } do
    root:add_child(stage.box('wall', pale, { b[1], 0, b[2] }, { b[3], 3.1, b[4] }))
end

-- The objects in the pool.
root:add_child(stage.box('plinth', stone, { -.5, 0, -.5 }, { .5, .9, .5 }))
local ring = gr.torus('ring', 1, .16)
ring:set_material(brass)
ring:scale(.8, .8, .8)
ring:rotate('x', 62)
ring:translate(0, 1.75, 0)
root:add_child(ring)
root:add_child(stage.ball('pearl', gr.rr_material({ .25, .25, .28 }, { .9, .9, .9 }, 200, .5, 0, 1), { 0, 1.75, 0 }, .42))

gr.render {
    node = root, file = "12demo.png", width = 640, height = 480,
    eye = { 3.9, 1.65, 5.3 }, view = { -.72, -.13, -1 }, up = { 0, 1, 0 }, fov = 58,
    ambient = { .42, .44, .50 }, background = gr.sky_gradient { { -1, .78, .74, .66 }, { .02, .86, .88, .90 }, { .5, .36, .56, .84 }, { 1, .20, .40, .74 } },
    lights = {
        gr.light({ 5, 20, 7 }, { .78, .70, .56 }, { 1, 0, 0 }),
        gr.light({ 0, 2.6, 0 }, { .16, .15, .12 }, { 1, 0, .02 }),
    },
}
