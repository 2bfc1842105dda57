-- TITLE: Animation: a puppet that walks
-- Hips, knees, ankles, shoulders and elbows turn about joints. A shoe that stands moves with the ground, and the angles
-- of its leg follow from where it is. Drawn in steps of light with lines.
-- Author: gray project

local cos, sin, pi, rad = math.cos, math.sin, math.pi, math.rad

local function paint(r, g, b) return gr.material({ r, g, b }, { 0, 0, 0 }, 1) end
local skin, shirt, trousers, leather, hat = paint(0.93, 0.70, 0.52), paint(0.86, 0.30, 0.24), paint(0.25, 0.34, 0.58), paint(0.28, 0.20, 0.16),
    paint(0.95, 0.78, 0.25)

-- The body leans forwards by LEAN degrees; a shoe is an ellipsoid, its middle (TOE, SOLE) from the ankle.
local THIGH, SHIN, HIPS, LEAN, STEP = 0.95, 0.95, 0.26, 4, 2.3
local SHOE, TOE, SOLE = { 0.30, 0.12, 0.14 }, 0.12, -0.03

local function smooth(u) return u * u * (3 - 2 * u) end

-- The shoe at a phase 0..1 of its leg: its middle, seen from the point below the hips, and its angle, toes up. For the
-- share STANDS of the time it stands: its middle moves with the ground, while it rolls from the heel to the toes.
local STANDS, FRONT = 0.58, 0.767
local function shoe(phase)
    local u = (phase - STANDS) / (1 - STANDS)
    local angle = 20 * (1 - smooth(math.min(1, phase / 0.1))) - 40 * smooth(math.max(0, (phase - 0.34) / 0.24))
    local x, lift = FRONT - STEP * phase, 0
    if u > 0 then
        angle, lift = -40 + 60 * smooth(u), 0.18 * sin(pi * u)
        x = FRONT - STEP * STANDS * (1 - smooth(u)) - 0.4 * u * (1 - u) * (1 - 2 * u)
    end
    local s, c = SHOE[1] * sin(rad(angle)), SHOE[2] * cos(rad(angle))
    return x, math.sqrt(s * s + c * c) + lift, angle
end

-- Height of the hips at a time 0..1 of the loop; it is largest above a leg that stands.
local function height(t) return 1.95 - 0.03 * cos(4 * pi * t) end

-- Angles in degrees, forwards, of a leg whose hip is at this height: thigh, knee and shoe.
local function leg(phase, hips)
    local x, y, angle = shoe(phase)
    local s, c = sin(rad(angle)), cos(rad(angle))
    x, y = x - (TOE * c - SOLE * s), hips - (y - (TOE * s + SOLE * c))
    local bend = math.deg(math.acos(math.min(1, math.sqrt(x * x + y * y) / (THIGH + SHIN))))
    return math.deg(math.atan(x, y)) + bend, 2 * bend, angle
end

local function ball(material, x, y, z, sx, sy, sz)
    return gr.sphere { material = material }:scale(sx, sy or sx, sz or sx):translate(x, y, z)
end
local function limb(material, length, from, to)
    local node = gr.node 'limb'
    node:add_child(gr.cone { from = { 0, 0, 0 }, to = { 0, -length, 0 }, from_radius = from, radius = to, material = material })
    node:add_child(ball(material, 0, 0, 0, from))
    node:add_child(ball(material, 0, -length, 0, to))
    return node
end
-- A joint: its children turn about the z axis through (x, y, z).
local function joint(parent, x, y, z)
    local node = gr.node 'joint'
    parent:add_child(node)
    return function(degrees, ...)
        for _, child in ipairs { ... } do node:add_child(child) end
        return node:reset():rotate('z', degrees):translate(x, y, z)
    end, node
end

local scene, body = gr.node 'scene', gr.node 'body'
scene:add_child(body)
body:add_child(ball(shirt, 0, 0.55, 0, 0.36, 0.62, 0.44))
body:add_child(ball(trousers, 0, 0.02, 0, 0.34, 0.28, 0.40))
local turn_head, head = joint(body, 0.03, 1.12, 0)
turn_head(0, limb(skin, 0.1, 0.12, 0.13), ball(skin, 0.03, 0.38, 0, 0.36), ball(skin, 0.40, 0.36, 0, 0.09),
    ball(leather, 0.32, 0.44, 0.15, 0.055), ball(leather, 0.32, 0.44, -0.15, 0.055),
    gr.cylinder { from = { -0.02, 0.62, 0 }, to = { -0.03, 0.67, 0 }, radius = 0.43, material = hat },
    gr.cone { from = { 0, 0.64, 0 }, to = { 0.03, 1.0, 0 }, from_radius = 0.32, radius = 0.24, material = hat })

local sides = {}
for i, z in ipairs { HIPS, -HIPS } do
    local turn_hip, hip = joint(body, 0, 0, z)
    local turn_knee, knee = joint(hip, 0, -THIGH, 0)
    local turn_ankle = joint(knee, 0, -SHIN, 0)
    turn_hip(0, limb(trousers, THIGH, 0.21, 0.16))
    turn_knee(0, limb(trousers, SHIN, 0.155, 0.11))
    turn_ankle(0, ball(leather, TOE, SOLE, 0, table.unpack(SHOE)))
    local turn_shoulder, shoulder = joint(body, 0, 0.98, 1.75 * z)
    local turn_elbow, elbow = joint(shoulder, 0, -0.62, 0)
    turn_shoulder(0, limb(shirt, 0.62, 0.15, 0.12))
    turn_elbow(0, limb(skin, 0.55, 0.11, 0.08), ball(skin, 0, -0.66, 0, 0.13))
    sides[i] = { hip = turn_hip, knee = turn_knee, ankle = turn_ankle, shoulder = turn_shoulder, elbow = turn_elbow, phase = (i - 1) / 2 }
end

-- Boards of two colours; the loop moves them on by both.
local ground = gr.node 'ground'
local board = STEP / 2
local greens = { paint(0.52, 0.72, 0.40), paint(0.46, 0.66, 0.36) }
for k = -12, 11 do
    ground:add_child(gr.box { min = { k * board, -0.3, -2.2 }, max = { (k + 1) * board, 0, 2.2 }, material = greens[k % 2 + 1] })
    if k % 2 == 0 then
        ground:add_child(gr.cylinder { from = { k * board, 0, -1.7 }, to = { k * board, 0.9, -1.7 }, radius = 0.09, material = paint(0.60, 0.44, 0.30) })
        ground:add_child(ball(paint(0.36, 0.60, 0.34), k * board, 1.25, -1.7, 0.62, 0.55, 0.45))
    end
end
scene:add_child(ground)

gr.frames {
    count = 32, loop = true, pure = true, fps = 25,
    draw = function(t)
        local hips = height(t)
        for _, s in ipairs(sides) do
            local phase = (t + s.phase) % 1
            local thigh, knee, angle = leg(phase, hips)
            s.hip(thigh + LEAN)
            s.knee(-knee)
            s.ankle(angle - thigh + knee)
            s.shoulder(-30 * cos(2 * pi * phase))
            s.elbow(22 - 12 * cos(2 * pi * phase))
        end
        turn_head(3 * sin(4 * pi * t))
        body:reset():rotate('z', -LEAN):translate(0, hips, 0)
        ground:reset():translate(-STEP * t, 0, 0)
        return {
            node = scene, width = 280, height = 280, eye = { 4.2, 2.6, 9 }, target = { 0, 1.78, 0 }, fov = 29.5, style = 'toon', line_width = 1.5,
            ambient = { 0.42, 0.42, 0.46 }, background = { 0.80, 0.90, 0.97 }, lights = { gr.light({ 11, 8, 9 }, { 0.62, 0.60, 0.55 }, { 1, 0, 0 }) },
        }
    end,
}
