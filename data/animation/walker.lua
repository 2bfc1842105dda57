-- TITLE: Animation: a puppet that walks
-- Hips, knees, ankles, shoulders and elbows turn about joints. The body is as high as the lower foot asks for, and the
-- ground moves with the foot that stands on it. Drawn in steps of light with lines.
-- Author: gray project

local cos, sin, pi, rad = math.cos, math.sin, math.pi, math.rad

local function paint(r, g, b) return gr.material({ r, g, b }, { 0, 0, 0 }, 1) end
local skin, shirt, trousers, shoe, hat = paint(0.93, 0.70, 0.52), paint(0.86, 0.30, 0.24), paint(0.25, 0.34, 0.58), paint(0.28, 0.20, 0.16),
    paint(0.95, 0.78, 0.25)

-- The body leans forwards by LEAN degrees, and the legs with it.
local THIGH, SHIN, FOOT, HIPS, LEAN = 0.95, 0.95, 0.15, 0.26, 4

-- Angles of a leg in degrees, forwards, at phase 0..1 of its own step.
local function leg(phase)
    local a = 2 * pi * phase
    local hip = 4 + 27 * cos(a)
    local knee = 9 + 52 * math.max(0, sin(a + 0.35)) ^ 1.5 * (phase < 0.5 and 0.12 or 1)
    if phase >= 0.5 then knee = 9 + 52 * math.max(0, -sin(a + 0.25)) ^ 1.5 end
    return hip, knee
end

-- The sole of a leg, seen from the hip: forwards and down.
local function sole(phase)
    local hip, knee = leg(phase)
    local h, k = rad(hip - LEAN), rad(hip - LEAN - knee)
    return THIGH * sin(h) + SHIN * sin(k), THIGH * cos(h) + SHIN * cos(k) + FOOT
end

-- The way of the ground at N moments: that of the lower foot.
local N = 480
local way, total = { [0] = 0 }, 0
for i = 1, N do
    local now, before = i / N, (i - 1) / N
    local _, right = sole(now % 1)
    local _, left = sole((now + 0.5) % 1)
    local standing = right > left and 0 or 0.5
    local x1, x0 = sole((now + standing) % 1), sole((before + standing) % 1)
    total = total + x0 - x1
    way[i] = total
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
    ball(shoe, 0.32, 0.44, 0.15, 0.055), ball(shoe, 0.32, 0.44, -0.15, 0.055),
    gr.cylinder { from = { -0.02, 0.62, 0 }, to = { -0.03, 0.67, 0 }, radius = 0.43, material = hat },
    gr.cone { from = { 0, 0.64, 0 }, to = { 0.03, 1.0, 0 }, from_radius = 0.32, radius = 0.24, material = hat })

local sides = {}
for i, z in ipairs { HIPS, -HIPS } do
    local turn_hip, hip = joint(body, 0, 0, z)
    local turn_knee, knee = joint(hip, 0, -THIGH, 0)
    local turn_ankle = joint(knee, 0, -SHIN, 0)
    turn_hip(0, limb(trousers, THIGH, 0.21, 0.16))
    turn_knee(0, limb(trousers, SHIN, 0.155, 0.11))
    turn_ankle(0, ball(shoe, 0.12, -0.03, 0, 0.30, 0.12, 0.14))
    local turn_shoulder, shoulder = joint(body, 0, 0.98, 1.75 * z)
    local turn_elbow, elbow = joint(shoulder, 0, -0.62, 0)
    turn_shoulder(0, limb(shirt, 0.62, 0.15, 0.12))
    turn_elbow(0, limb(skin, 0.55, 0.11, 0.08), ball(skin, 0, -0.66, 0, 0.13))
    sides[i] = { hip = turn_hip, knee = turn_knee, ankle = turn_ankle, shoulder = turn_shoulder, elbow = turn_elbow, phase = (i - 1) / 2 }
end

-- Boards of two colours; the loop moves them on by both.
local ground = gr.node 'ground'
local board = total / 2
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
    count = 32, loop = true, fps = 25,
    draw = function(t)
        local low = 0
        for _, s in ipairs(sides) do
            local phase = (t + s.phase) % 1
            local hip, knee = leg(phase)
            local _, down = sole(phase)
            low = math.max(low, down)
            s.hip(hip)
            s.knee(-knee)
            s.ankle(knee - hip + LEAN + (phase >= 0.5 and 10 * sin(2 * pi * phase) or 0))
            s.shoulder(-30 * cos(2 * pi * phase))
            s.elbow(22 - 12 * cos(2 * pi * phase))
        end
        turn_head(3 * sin(4 * pi * t))
        body:reset():rotate('z', -LEAN):translate(0, low, 0)
        ground:reset():translate(-way[math.floor(t * N + 0.5)], 0, 0)
        return {
            node = scene, width = 280, height = 280, eye = { 4.2, 2.6, 9 }, target = { 0, 1.78, 0 }, fov = 29.5, style = 'toon', line_width = 1.5,
            ambient = { 0.42, 0.42, 0.46 }, background = { 0.80, 0.90, 0.97 }, lights = { gr.light({ 11, 8, 9 }, { 0.62, 0.60, 0.55 }, { 1, 0, 0 }) },
        }
    end,
}
