-- TITLE: Animation: clockwork
-- Two layers of involute wheels. In one loop the first pair moves on by 10 teeth and the second by 15: every wheel ends
-- at a multiple of the angle between its spokes, so the last frame leads to the first. In a frame no wheel turns by more
-- than a third of a tooth: at half a tooth its direction could no longer be seen.
-- Author: gray project

local gear = require 'gear'

local module = 0.1
local brass = gr.material({ 0.66, 0.48, 0.17 }, { 0.75, 0.62, 0.36 }, 40)
local bronze = gr.material({ 0.58, 0.31, 0.17 }, { 0.7, 0.48, 0.35 }, 40)
local steel = gr.material({ 0.52, 0.54, 0.58 }, { 0.6, 0.62, 0.65 }, 50)
local plate = gr.material({ 0.20, 0.24, 0.27 }, { 0.12, 0.12, 0.12 }, 25)

local scene = gr.node 'clockwork'
local wheels = {}

--- A wheel with `spokes` openings between its spokes, as a prism; it turns by `turn` degrees in a loop.
local function wheel(g, spokes, material, x, y, z, angle, turn)
    local bore, rim = 0.22, g.root - 0.14
    local inner, half, holes = bore + 0.16, math.pi / spokes, {}
    for k = 0, spokes - 1 do
        local hole, steps = {}, 16
        local function arc(radius, from, to)
            for i = 0, steps do
                local a = 2 * half * k + (half - 0.10 / radius) * (from + (to - from) * i / steps)
                hole[#hole + 1] = { radius * math.cos(a), -radius * math.sin(a) }
            end
        end
        arc(rim, -1, 1)
        arc(inner, 1, -1)
        holes[k + 1] = hole
    end
    local outline = gear.outline(g, 4)
    for _, q in ipairs(outline) do q[2] = -q[2] end -- the prism stands on y, turned onto z
    local node = gr.node 'wheel'
    node:add_child(gr.prism { outline = outline, holes = holes, from = -0.13, to = 0.13, material = material }:rotate('x', 90))
    node:add_child(gr.cylinder { from = { 0, 0, -0.75 - z }, to = { 0, 0, 0.24 }, radius = bore, material = steel })
    scene:add_child(node)
    wheels[#wheels + 1] = { node = node, x = x, y = y, z = z, angle = angle, turn = turn }
end

--- Puts a wheel beside another one: at `direction` degrees of it.
local function beside(a, b, angle, direction, x, y)
    local distance, other = gear.mate(a, b, angle, direction)
    return x + distance * math.cos(math.rad(direction)), y + distance * math.sin(math.rad(direction)), other
end

local great, pinion, slow, third = gear.new { teeth = 40, module = module }, gear.new { teeth = 20, module = module },
    gear.new { teeth = 30, module = module }, gear.new { teeth = 45, module = module }
wheel(great, 4, brass, -3.5, 0.1, 0, 0, 90)
local px, py, pa = beside(great, pinion, 0, 24, -3.5, 0.1)
wheel(pinion, 2, steel, px, py, 0, pa, -180)
local sx, sy, sa = beside(great, slow, 0, 78, -3.5, 0.1)
wheel(slow, 3, bronze, sx, sy, 0, sa, -120)
-- On the axle of the pinion, behind it.
wheel(slow, 6, bronze, px, py, -0.36, 7, -180)
local tx, ty, ta = beside(slow, third, 7, -38, px, py)
wheel(third, 3, brass, tx, ty, -0.36, ta, 120)

local pendulum = gr.node 'pendulum'
pendulum:add_child(gr.cylinder { from = { 0, 0, 0 }, to = { 0, -2.1, 0 }, radius = 0.05, material = steel })
pendulum:add_child(gr.cylinder { from = { 0, -2.1, -0.10 }, to = { 0, -2.1, 0.10 }, radius = 0.45, material = brass })
pendulum:add_child(gr.sphere { radius = 0.16, material = steel })
scene:add_child(pendulum)
scene:add_child(gr.box { min = { -9, -9, -1.1 }, max = { 9, 9, -0.75 }, material = plate })
for _, p in ipairs { { -5.5, 4.7 }, { 5.4, 4.7 }, { -5.5, -3.3 }, { 5.4, -3.3 } } do
    scene:add_child(gr.sphere { centre = { p[1], p[2], -0.78 }, radius = 0.2, material = steel })
end

local lights = {
    gr.light({ -5, 8, 9 }, { 0.86, 0.82, 0.74 }, { 1, 0, 0 }), gr.light({ 7, 2, 10 }, { 0.28, 0.31, 0.37 }, { 1, 0, 0 }),
}
gr.frames {
    count = 48, loop = true, pure = true, fps = 30,
    draw = function(t)
        for _, w in ipairs(wheels) do w.node:reset():rotate('z', w.angle + w.turn * t):translate(w.x, w.y, w.z) end
        pendulum:reset():rotate('z', 15 * math.sin(2 * math.pi * t)):translate(2.5, 4.1, -0.3)
        return {
            node = scene, width = 320, height = 240, eye = { 0.2, -0.2, 15 }, target = { -0.1, 0.72, -0.3 }, fov = 35,
            ambient = { 0.30, 0.30, 0.32 }, background = { 0.1, 0.12, 0.14 }, lights = lights,
        }
    end,
}
