-- TITLE: Library: solids as functions
-- Primitives and operators of sdf.lua, each an implicit solid.
-- Author: gray project

local studio, colour = require 'studio', require 'colour'
local sdf = require 'sdf'

local box = { { -1, -1, -1 }, { 1, 1, 1 } }
local cut = sdf.difference(sdf.smooth_intersection(0.1, sdf.sphere(0.85), sdf.box { 0.68, 0.68, 0.68 }), sdf.cylinder(0.4, 2), sdf.rotate(sdf.cylinder(0.4, 2), 'x', 90),
    sdf.rotate(sdf.cylinder(0.4, 2), 'z', 90))
local list = {
    sdf.smooth_union(0.3, sdf.translate(sdf.sphere(0.5), { -0.35, -0.3, 0 }), sdf.translate(sdf.sphere(0.35), { 0.4, 0.1, 0 }), sdf.translate(sdf.sphere(0.25), { 0, 0.6, 0.2 })),
    cut,
    sdf.twist(sdf.round(sdf.box { 0.42, 0.85, 0.42 }, 0.08), 70),
    sdf.intersection(sdf.gyroid(0.7, 0.11), sdf.sphere(0.95)),
    sdf.bend(sdf.extrude(sdf.rectangle(0.85, 0.12), 0.4), 55),
    sdf.revolve(sdf.union(sdf.polygon(6, 0.2), sdf.rectangle(0.08, 0.5)), 0.65),
}

local scene = gr.node 'solids'
for k, f in ipairs(list) do
    local item = gr.implicit { f = f, bounds = box, material = studio.matt(colour.hsv(60 * k - 30, 0.6, 0.75)) }
    studio.place(scene, item, ((k - 1) % 3 - 1) * 2.35, 0.97, k <= 3 and -1.4 or 1.4, 25)
end
studio.render { node = scene, file = 'show_sdf.png', eye = { 0, 5.4, 13 }, target = { 0, 0.6, 0 }, fov = 26, floor = { 0.5, 0.5, 0.52 } }
