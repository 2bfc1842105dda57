-- TITLE: Reflection and refraction
-- A mirror ball, clear and coloured glass, a glass shell, a bubble of air in a block, and a floor with a faint
-- reflection. Author: gray project

local stage = require 'stage'
local polyhedra = require 'polyhedra'
local knot = require 'knot'

local root = gr.node('root')

root:add_child(stage.checkers('floor', gr.rr_material({ .12, .16, .20 }, { .5, .5, .5 }, 60, .35, 0, 1),
    gr.rr_material({ .78, .76, .70 }, { .4, .4, .4 }, 60, .25, 0, 1), -9, -12, 9, 6, .9))

local mirror = gr.rr_material({ .02, .02, .02 }, { .90, .92, .95 }, 200, 1, 0, 1)
local glass = gr.rr_material({ 0, 0, 0 }, { .97, .98, .97 }, 300, .08, .92, 1.5)
local rose = gr.rr_material({ .02, 0, 0 }, { 1, .72, .74 }, 200, .10, .90, 1.4)
local green = gr.rr_material({ 0, .02, 0 }, { .45, .95, .60 }, 200, .10, .90, 1.5)
local air = gr.rr_material({ 0, 0, 0 }, { 1, 1, 1 }, 200, .04, .96, 1)

root:add_child(stage.ball('mirror', mirror, { -1.75, 1.1, -1.5 }, 1.1))
root:add_child(stage.ball('glass', glass, { .15, .72, .5 }, .72))

-- a block of rose glass with a bubble in it
local block = gr.node('block')
block:add_child(stage.box('rose', rose, { -.6, 0.002, -.6 }, { .6, 1.2, .6 }))
block:add_child(stage.ball('bubble', air, { 0, .62, 0 }, .38))
block:rotate('y', 28)
block:translate(1.95, 0, -.2)
root:add_child(block)

-- a thin shell: outside glass, inside air
local shell = gr.node('shell')
shell:add_child(stage.ball('outer', green, { 0, 0, 0 }, .5))
shell:add_child(stage.ball('inner', air, { 0, 0, 0 }, .46))
shell:translate(-1.2, .502, 1.15)
root:add_child(shell)

-- something to look at behind the glass
local rope = stage.smooth('knot', gr.rr_material({ .72, .42, .10 }, { .5, .45, .3 }, 50, .15, 0, 1),
    knot.mesh(2, 3, { n = 260, around = 20, radius = .17 }))
rope:rotate('x', 70)
rope:scale(.75, .75, .75)
rope:translate(.9, 1.05, -4.4)
root:add_child(rope)
local gem = gr.geometry('gem', gr.mesh(gr.material({ .16, .30, .62 }, { .5, .5, .5 }, 60), polyhedra.dodecahedron()))
gem:scale(.55, .55, .55)
gem:rotate('x', 20)
gem:translate(3.4, .52, -3.2)
root:add_child(gem)
root:add_child(stage.ball('red', gr.material({ .75, .12, .10 }, { .5, .5, .5 }, 60), { .75, .35, -2.9 }, .35))
root:add_child(stage.ball('yellow', gr.material({ .85, .66, .12 }, { .5, .5, .5 }, 60), { -.35, .3, -2.3 }, .3))

gr.render {
    node = root, file = '02demo.png', width = 640, height = 480,
    eye = { .3, 2.1, 6.2 }, view = { -.03, -.20, -1 }, fov = 43,
    ambient = { .28, .28, .30 }, background = { .62, .72, .84 }, use_tir = true,
    lights = {
        gr.light({ -5, 8, 6 }, { .70, .68, .62 }, { 1, 0, 0 }),
        gr.light({ 6, 6, 3 }, { .28, .30, .36 }, { 1, 0, 0 }),
    },
}
