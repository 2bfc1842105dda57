-- TITLE: Library: solids as functions
-- Every function of sdf.lua, each an implicit solid; docs/library.md describes them.
-- Author: gray project

local studio, colour = require 'studio', require 'colour'
local sdf, text = require 'sdf', require 'text'

local ball, cube, bar = sdf.sphere(0.55), sdf.box { 0.45, 0.45, 0.45 }, sdf.box { 0.22, 0.75, 0.22 }
local left, right = sdf.translate(ball, { -0.25, -0.15, 0 }), sdf.translate(sdf.sphere(0.4), { 0.35, 0.25, 0 })
local flat = function(f) return sdf.extrude(f, 0.2) end
local list = {
    { 'sphere', sdf.sphere(0.7) },
    { 'box', sdf.box { 0.6, 0.45, 0.5 } },
    { 'torus', sdf.rotate(sdf.torus(0.55, 0.2), 'x', 60) },
    { 'cylinder', sdf.cylinder(0.5, 0.6) },
    { 'capsule', sdf.capsule({ -0.45, -0.35, 0 }, { 0.45, 0.4, 0 }, 0.3, 0.15) },
    { 'ellipsoid', sdf.ellipsoid { 0.8, 0.4, 0.5 } },
    { 'gyroid', sdf.intersection(sdf.gyroid(0.6, 0.1), sdf.sphere(0.75)) },
    { 'plane', sdf.intersection(sdf.plane({ 1, 1, 0.4 }, 0.1), sdf.sphere(0.7)) },
    { 'circle', flat(sdf.circle(0.6)) },
    { 'rectangle', flat(sdf.rectangle(0.7, 0.4)) },
    { 'polygon', flat(sdf.polygon(5, 0.55)) },
    { 'extrude', sdf.extrude(sdf.difference(sdf.polygon(6, 0.55), sdf.circle(0.3)), 0.3) },
    { 'revolve', sdf.revolve(sdf.union(sdf.polygon(6, 0.16), sdf.rectangle(0.07, 0.4)), 0.5) },
    { 'translate', sdf.union(cube, sdf.translate(sdf.sphere(0.25), { 0.45, 0.45, 0.45 })) },
    { 'union', sdf.union(left, right) },
    { 'intersection', sdf.intersection(sdf.sphere(0.62), cube) },
    { 'difference', sdf.difference(cube, sdf.translate(ball, { 0.3, 0.3, 0.4 })) },
    { 'smooth_union', sdf.smooth_union(0.4, left, right) },
    { 'smooth_intersection', sdf.smooth_intersection(0.3, sdf.sphere(0.65), sdf.box { 0.5, 0.5, 0.5 }) },
    { 'smooth_difference', sdf.smooth_difference(0.2, cube, sdf.translate(ball, { 0.3, 0.3, 0.4 })) },
    { 'round', sdf.round(sdf.box { 0.35, 0.35, 0.35 }, 0.15) },
    { 'shell', sdf.difference(sdf.shell(sdf.sphere(0.65), 0.08), sdf.translate(sdf.box { 1, 1, 1 }, { 0.8, 0.9, 0.9 })) },
    { 'rotate', sdf.rotate(bar, 'z', 35) },
    { 'scale', sdf.union(sdf.translate(sdf.scale(cube, 0.9), { -0.25, -0.2, 0 }), sdf.translate(sdf.scale(cube, 0.5), { 0.4, 0.43, 0 })) },
    { 'mirror', sdf.mirror(sdf.capsule({ 0.1, -0.5, 0 }, { 0.55, 0.4, 0 }, 0.12, 0.2)) },
    { 'twist', sdf.twist(sdf.box { 0.35, 0.75, 0.35 }, 80) },
    { 'bend', sdf.translate(sdf.bend(sdf.box { 0.75, 0.12, 0.35 }, 70), { 0, -0.25, 0 }) },
    { 'repeated', sdf.repeated(sdf.round(sdf.box { 0.1, 0.1, 0.1 }, 0.04), { 0.4, 0.4, 0.4 }, { 1, 1, 1 }) },
}

local scene = gr.node 'solids'
local ink = gr.material { kd = { 0, 0, 0 }, emission = { 0.75, 0.74, 0.70 } } -- shines, so no shadow covers a word
for k, entry in ipairs(list) do
    local name, f = entry[1], entry[2]
    local x, y = ((k - 1) % 7 - 3) * 2.1, (3 - (k - 1) // 7) * 2.15
    local material = studio.glaze(colour.hsv(47 * k, 0.7, 0.6))
    local item = gr.implicit { f = f, bounds = { { -0.9, -0.9, -0.9 }, { 0.9, 0.9, 0.9 } }, material = material }
    scene:add_child(item:rotate('Y', -25):rotate('X', 15):translate(x, y + 1.35, 0))
    scene:add_child(text.node(name, { size = 0.24, depth = 0.05, align = 'centre', material = ink }):translate(x, y + 0.14, 0))
end
studio.render {
    node = scene, file = 'show_sdf.png', size = { 960, 540 }, spp = 3, eye = { 0, 4.6, 24 }, target = { 0, 4.4, 0 }, fov = 22.5, key = { -9, 12, 16 }, lamp = 2,
    light = { 1.0, 0.88, 0.72 }, floor = { 0.20, 0.17, 0.22 }, sky = { 0.22, 0.22, 0.30 },
}
