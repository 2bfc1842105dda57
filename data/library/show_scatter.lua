-- TITLE: Library: points with a minimum distance
-- A ball with nails at least 0.17 apart, a torus knot with exactly 900 beads by sample
-- elimination, a meadow of Bridson's algorithm, and beside it the same number of uniformly random blades.
-- Author: gray project

local studio = require 'studio'
local colour, knot, polyhedra, random, scatter = require 'colour', require 'knot', require 'polyhedra', require 'random', require 'scatter'

local scene = gr.node 'scatter'
local function at(x, y, z, ...)
    local node = gr.node 'at'
    node:translate(x, y, z)
    for _, child in ipairs { ... } do node:add_child(child) end
    scene:add_child(node)
end

-- The ball and its nails.
local verts, _, faces = polyhedra.geodesic(quick and 2 or 4)
local nail = gr.node 'nail'
nail:add_child(gr.cylinder { from = { 0, -0.02, 0 }, to = { 0, 0.1, 0 }, radius = 0.016, material = studio.silver })
nail:add_child(gr.sphere { centre = { 0, 0.11, 0 }, radius = 0.045, material = studio.gold })
at(-2.9, 1.11, 0, gr.sphere(studio.glaze { 0.12, 0.22, 0.42 }), scatter.place(scatter.mesh(verts, faces, { radius = quick and 0.5 or 0.17, seed = 4 }), nail))

-- The knot and its beads.
local path = knot.curve(2, 3, 160)
verts, _, faces = knot.tube(path, 0.24, 12)
local beads = {}
for k = 1, 5 do beads[k] = gr.sphere { radius = 0.075, material = studio.glaze(colour.palette('sunset', k / 5)) } end
local upright = gr.node 'upright'
upright:rotate('x', 78)
upright:add_child(gr.vn_mesh(studio.matt { 0.20, 0.17, 0.26 }, knot.tube(path, 0.24, 24)))
upright:add_child(scatter.place(scatter.mesh(verts, faces, { count = quick and 60 or 900, seed = 2 }), beads, { sink = -0.03 }))
at(0.45, 1.62, -0.6, upright)

-- Two meadows of as many blades.
local dice = random.new(8)
local blade = gr.cone { from = { 0, 0, 0 }, from_radius = 0.035, to = { 0.05, 0.42, 0.02 }, radius = 0.002, material = studio.matt { 0.25, 0.50, 0.16 } }
local pale = gr.cone { from = { 0, 0, 0 }, from_radius = 0.035, to = { 0.05, 0.42, 0.02 }, radius = 0.002, material = studio.matt { 0.62, 0.52, 0.20 } }
local spread, chance = scatter.rectangle(1.9, 1.9, quick and 0.4 or 0.098, { seed = 3 }), {}
for k = 1, #spread do chance[k] = { dice:range(0, 1.9), dice:range(0, 1.9) } end
local function bed(z, places, node)
    at(2.3, 0, z, gr.box { min = { -0.06, 0, -0.06 }, max = { 1.96, 0.14, 1.96 }, material = studio.matt { 0.33, 0.24, 0.17 } })
    at(2.3, 0.13, z, scatter.place(places, node, { scale = { 0.8, 1.2 } }))
end
bed(-1.9, chance, pale)
bed(0.45, spread, blade)

studio.render { node = scene, file = 'show_scatter.png', eye = { 0.1, 5.4, 12.5 }, target = { 0.35, 0.95, 0 }, fov = 25, key = { 3, 16, 6 }, lamp = 10,
    floor = { 0.36, 0.34, 0.30 }, sky = { 0.34, 0.38, 0.44 } }
