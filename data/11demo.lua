-- TITLE: Skybox
-- A lake in the evening on all sides, seen directly and in mirrors; the second picture has letters on the six faces of
-- the sky. Author: gray project

local stage = require 'stage'
local knot = require 'knot'
local teapot = require 'teapot'

local root = gr.node('root')
local chrome = gr.rr_material({ .02, .02, .02 }, { .92, .93, .95 }, 250, 1, 0, 1)
local copper = gr.rr_material({ .08, .03, .01 }, { .95, .62, .42 }, 120, .85, 0, 1)
local glass = gr.rr_material({ 0, 0, 0 }, { .97, .98, .98 }, 250, .06, .94, 1.5)

root:add_child(stage.ball('mirror', chrome, { 0, 0, 0 }, 1))
local ring = stage.smooth('knot', copper, knot.mesh(2, 5, { n = 420, around = 24, big = 1.9, small = .34, radius = .11 }))
ring:rotate('x', 14)
ring:rotate('z', 8)
root:add_child(ring)
local pot = stage.smooth('pot', chrome, teapot.mesh(12))
pot:scale(.34, .34, .34)
pot:rotate('y', 200)
pot:rotate('z', 6)
pot:translate(2.6, .1, -1.2)
root:add_child(pot)
root:add_child(stage.ball('drop', glass, { -2.35, .35, -1.5 }, .62))
root:add_child(stage.ball('pearl', chrome, { -1.5, -1.0, -1.9 }, .28))

local lights = { gr.light({ 8, 4, 14 }, { .7, .55, .38 }, { 1, 0, 0 }) }

-- looking towards F, the +z face, with the sun on the left
gr.render_skybox(root, '11demo.png', '../textures/sky_evening.png', 640, 480, { 0, .45, -5.2 }, { .03, -.02, 1 },
    { 0, 1, 0 }, 62, { .3, .3, .3 }, lights)
gr.render_skybox(root, '11demo_letters.png', '../textures/sky_letters.png', 480, 360, { 0, .45, -4 }, { .25, -.03, 1 },
    { 0, 1, 0 }, 104, { .3, .3, .3 }, lights)
