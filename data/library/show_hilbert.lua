-- TITLE: Library: a path through every part of a cube
-- Hilbert's curve in space, 512 places in 511 steps, grown by an L-system: a rainbow of tubes with round corners; Koch's
-- snowflake as a tray.
-- Author: gray project

local studio = require 'studio'
local colour, lsystem = require 'colour', require 'lsystem'

local scene = gr.node 'hilbert'
local walk = lsystem.example('hilbert', 3, { radius = 0.24 })
local points, pieces, looks = walk.branches[1].points, 48, {}
local cube = gr.node 'curve'
cube:translate(-walk.low[1] - 3.5, -walk.low[2] + 0.85, -walk.low[3] - 3.5)
for k = 1, pieces do
    local from, to = (k - 1) * (#points - 1) // pieces + 1, k * (#points - 1) // pieces + 1
    looks[k] = studio.glaze(colour.hsv(330 * (k - 1) / pieces, 0.72, 0.78), 0.1)
    cube:add_child(gr.sweep { points = table.move(points, from, to, 1, {}), radii = 0.24, spline = 'linear', material = looks[k] })
end
local turned = gr.node 'turned'
turned:rotate('y', 33)
turned:add_child(cube)
scene:add_child(turned)

-- The tray: the extruded snowflake, with a hexagon of wood on it.
local flake = lsystem.example('koch', 4, { length = 14.5 / 81 })
local outline = {}
local rim = flake.branches[1].points
local middle = { (flake.low[1] + flake.high[1]) / 2, (flake.low[2] + flake.high[2]) / 2 }
for k = 1, #rim - 1 do outline[k] = { rim[k][1] - middle[1], rim[k][2] - middle[2] } end
local tray = gr.node 'tray'
tray:rotate('y', 12)
tray:add_child(gr.prism { outline = outline, from = 0, to = 0.4, material = studio.glaze { 0.05, 0.055, 0.07 } })
scene:add_child(tray)

studio.render {
    node = scene, file = 'show_hilbert.png', eye = { 0, 13.5, 26 }, target = { 0, 3.2, 0 }, fov = 30, key = { -14, 22, 12 }, lamp = 8,
    floor = { 0.44, 0.41, 0.36 }, back = -16, light = { 1.5, 1.25, 0.95 },
}
