-- TITLE: Library: knots
-- Six knots as tubes that are not twisted; the golden torus knot (3, 8) is the exact sweep of a ball.
-- Author: gray project

local studio = require 'studio'
local colour, knot = require 'colour', require 'knot'

local scene = gr.node 'knots'
local names = { 'trefoil', 'figure eight', 'cinquefoil', 'torus', 'three twist', 'septafoil' }
for k, name in ipairs(names) do
    local upright, turned, placed = gr.node(name), gr.node 'turned', gr.node 'placed'
    local path = name == 'torus' and knot.curve(3, 4, 320, 1, 0.42) or knot.named(name, 320)
    -- all of one size
    local low, high = require 'meshes'.bounds(path)
    local flat = name ~= 'three twist'
    local size = (flat and 2.3 or 1.8) / math.max(high[1] - low[1], high[2] - low[2], high[3] - low[3])
    for _, p in ipairs(path) do
        for d = 1, 3 do p[d] = size * (p[d] - (low[d] + high[d]) / 2) end
    end
    if flat then upright:rotate('x', 90) end
    upright:add_child(gr.vn_mesh(studio.glaze(colour.palette('toy', (k - 1) / 5), 0.12), knot.tube(path, 0.17, 28)))
    turned:rotate('y', 8 * (3.5 - k))
    turned:add_child(upright)
    local lowest = turned:bounds()
    placed:translate(3.05 * ((k - 1) % 3 - 1), -lowest[2] + (k > 3 and 0 or 0.9), k > 3 and 1.6 or -1.7)
    placed:add_child(turned)
    scene:add_child(placed)
    if k <= 3 then
        scene:add_child(gr.cylinder { from = { 3.05 * (k - 2), 0, -1.7 }, to = { 3.05 * (k - 2), 0.9, -1.7 }, radius = 1.15, material = studio.matt { 0.80, 0.78, 0.74 } })
    end
end
-- The golden one lies in front.
local ring = gr.node 'ring'
ring:translate(0, 0.27, 4.1)
ring:add_child(gr.sweep { points = knot.curve(3, 8, 150, 1.15, 0.2), radii = 0.075, loop = true, material = studio.gold })
scene:add_child(ring)

studio.render { node = scene, file = 'show_knots.png', eye = { 0, 6.6, 15.5 }, target = { 0, 0.95, 0.4 }, fov = 25.5 }
