-- TITLE: Library: gears
-- Involute teeth: a planetary train in its ring, a pair of herringbone wheels, a pinion on a rack. They touch without
-- intersecting; tests/library/claims_gear.lua checks it.
-- Author: gray project

local studio = require 'studio'
local gear = require 'gear'

local scene = gr.node 'gears'
local brass = gr.metal_material { metal = 'brass', roughness = 0.28 }
local steel = gr.metal_material { metal = 'iron', roughness = 0.35 }
local blue = studio.glaze { 0.035, 0.085, 0.25 }
local red = studio.glaze { 0.40, 0.03, 0.02 }

--- A wheel with an axle, with holes if it is large, rotated and at its position; the axis of wheels is z.
local function wheel(g, material, x, y, z, angle, options)
    local node, placed = gr.node 'wheel', gr.node 'placed'
    node:rotate('z', angle)
    local solid = gr.vn_mesh(material, gear.mesh(g, options))
    local holes = not g.inside and g.root > 0.75 and (g.teeth > 30 and 7 or 5) or 0
    for k = 1, holes do
        local a, q = 2 * math.pi * k / holes, (options.bore + g.root) / 2
        solid = gr.difference('hole', solid, gr.cylinder { from = { q * math.cos(a), q * math.sin(a), -1 },
            to = { q * math.cos(a), q * math.sin(a), 1 }, radius = 0.24 * (g.root - options.bore) + 0.05, material = material })
    end
    node:add_child(solid)
    placed:translate(x, y, z)
    placed:add_child(node)
    if options.bore and not g.inside then
        placed:add_child(gr.cylinder { from = { 0, 0, -0.5 }, to = { 0, 0, 0.32 }, radius = options.bore * 0.99, material = steel })
    end
    return placed
end

-- The train stands upright on the left.
local train = gear.planetary { sun = 24, planet = 18, planets = 3, module = 0.085, turn = 20 }
local left = gr.node 'train'
left:add_child(wheel(train.ring, steel, 0, 0, 0, train.ring_angle, { width = 0.42, bore = train.ring.root + 0.28 }))
left:add_child(wheel(train.sun, brass, 0, 0, 0, train.sun_angle, { width = 0.36, bore = 0.3 }))
for _, p in ipairs(train.planets) do left:add_child(wheel(train.planet, blue, p[1], p[2], 0, p[3], { width = 0.36, bore = 0.18 })) end
local foot = train.ring.root + 0.28
local function stand(node, x, y, z, turn) studio.place(scene, node, x, y, z, turn) end
stand(left, -3.3, foot, -0.4, 18)

-- Herringbone wheels in the middle.
local big, small = gear.new { teeth = 34, module = 0.085 }, gear.new { teeth = 17, module = 0.085 }
local distance, angle = gear.mate(big, small, 3, 62)
local middle = gr.node 'herringbone'
middle:add_child(wheel(big, brass, 0, 0, 0, 3, { width = 0.8, bore = 0.26, helix = 26, double = true, layers = 12 }))
middle:add_child(wheel(small, steel, distance * math.cos(math.rad(62)), distance * math.sin(math.rad(62)), 0, angle,
    { width = 0.8, bore = 0.2, helix = -26, double = true, layers = 12 }))
stand(middle, 0.55, big.tip, 0.2, -14)

-- A pinion on a rack on the right: its teeth point up, and the wheel above has a tooth in a gap.
local pinion = gear.new { teeth = 20, module = 0.12 }
local rack = gr.node 'rack'
local lying = gr.node 'lying'
lying:rotate('x', 90)
local outline = gear.rack(pinion, 9, 2)
for _, p in ipairs(outline) do p[2] = -p[2] end
lying:add_child(gr.prism { outline = outline, from = -0.25, to = 0.25, material = steel })
rack:add_child(lying)
rack:add_child(wheel(pinion, red, 0, pinion.radius, 0, -90, { width = 0.5, bore = 0.3 }))
stand(rack, 3.9, 0.12 * 3.25, 0.4, -24)

studio.render { node = scene, file = 'show_gears.png', eye = { -0.2, 4.4, 16.5 }, target = { -0.4, 2.2, 0 }, fov = 26, floor = { 0.10, 0.12, 0.15 },
    key = { -11, 8, 7 }, light = { 1.9, 1.5, 1.05 }, sky = { 0.10, 0.13, 0.19 } }
