-- TITLE: Textures
-- Images on cubes and spheres: the six faces of a cube, tiles, a label, a globe, a ball, and a star with alpha over marble.
-- Author: gray project

local stage = require 'stage'

local root = gr.node('root')
local folder = '../textures/'

local plain = gr.material({ .7, .7, .7 }, { .25, .25, .25 }, 40)
local polished = gr.rr_material({ .7, .7, .7 }, { .35, .35, .35 }, 60, .22, 0, 1)

-- the floor: instances of one tiled slab
local slab = gr.geometry('slab', gr.cube(gr.td_cube_material(polished, folder .. 'tiles.png')))
slab:scale(1.999, .1, 1.999)
for i = -4, 3 do
    for j = -6, 1 do
        local at = gr.node('slab at')
        at:translate(2 * i, -.1, 2 * j)
        at:add_child(slab)
        root:add_child(at)
    end
end
root:add_child(stage.box('ground', gr.material({ .3, .3, .28 }, { 0, 0, 0 }, 1), { -9, -.5, -13 }, { 9, -.05, 5 }))

local checker = gr.geometry('checker', gr.cube(gr.td_cube_material(plain, folder .. 'checker.png')))
checker:translate(-.5, 0, -.5)
checker:scale(1.7, 1.7, 1.7)
checker:rotate('y', 32)
checker:translate(-2.1, .001, -.9)
root:add_child(checker)

-- by its formula the image appears mirrored from outside; flip_u reverses it
local globe = gr.geometry('globe', gr.sphere(gr.td_sphere_material { material = plain, png = folder .. 'earth.png', flip_u = true }))
globe:rotate('y', 130)
globe:rotate('z', -23)
globe:scale(1.15, 1.15, 1.15)
globe:translate(.45, 1.151, -1.9)
root:add_child(globe)

local toy = gr.geometry('ball', gr.sphere(gr.td_sphere_material(polished, folder .. 'ball.png')))
toy:rotate('x', 50)
toy:rotate('y', 20)
toy:scale(.55, .55, .55)
toy:translate(-.35, .551, 1.1)
root:add_child(toy)

local tin = gr.geometry('tin', gr.cube(gr.td_cube_material(plain, folder .. 'label.png')))
tin:translate(-.5, 0, -.5)
tin:scale(.95, 1.2, .95)
tin:rotate('y', -24)
tin:translate(2.25, .001, .15)
root:add_child(tin)

-- the star's alpha lets the marble below it through: decorators compose
local veined = gr.marble_pnd_material(polished, 2.2, 6, 7, 1, { .16, .22, .34 })
local block = gr.geometry('block', gr.cube(gr.td_cube_material(veined, folder .. 'star.png')))
block:translate(-.5, 0, -.5)
block:scale(.85, .85, .85)
block:rotate('y', 40)
block:translate(1.05, .001, 1.35)
root:add_child(block)

gr.render_skybox(root, '05demo.png', folder .. 'sky_evening.png', 640, 480, { .2, 2.25, 6.6 }, { -.03, -.21, -1 },
    { 0, 1, 0 }, 38, { .34, .34, .36 }, {
        gr.light({ -5, 8, 7 }, { .70, .66, .58 }, { 1, 0, 0 }),
        gr.light({ 6, 5, 5 }, { .22, .24, .30 }, { 1, 0, 0 }),
    })
