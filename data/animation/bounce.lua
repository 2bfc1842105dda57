-- TITLE: Animation: bouncing balls
-- Balls fly along parabolas, with their velocity for the motion blur; on the floor they are squashed and stretched with
-- the same volume. A shutter of 180 degrees.
-- Author: gray project

local pi, sqrt = math.pi, math.sqrt
local FPS, SECONDS, CONTACT = 25, 1.2, 0.12
local GRAVITY = 12

local function rubber(r, g, b) return gr.material { kd = { r, g, b }, ks = { 0.35, 0.35, 0.35 }, shininess = 50 } end

-- radius, number of flights in a loop, phase, position. In no frame does a ball just touch or just leave the floor.
local balls = {
    { 0.62, 1, 0.12, { -1.9, 0.3 }, rubber(0.83, 0.22, 0.18) }, { 0.44, 2, 0.45, { -0.15, -0.5 }, rubber(0.95, 0.72, 0.18) },
    { 0.50, 1, 0.62, { 1.25, 0.5 }, rubber(0.20, 0.52, 0.78) }, { 0.33, 2, 0.22, { 2.45, -0.2 }, rubber(0.38, 0.66, 0.30) },
}
local scene = gr.node 'scene'
for _, b in ipairs(balls) do
    b.node = gr.node 'ball'
    b.node:add_child(gr.sphere { radius = b[1], material = b[5] })
    scene:add_child(b.node)
end
local function floor(p)
    local checker = (math.floor(p.x) + math.floor(p.z)) % 2
    return gr.mix({ 0.80, 0.77, 0.72 }, { 0.62, 0.60, 0.60 }, checker)
end
scene:add_child(gr.plane { normal = { 0, 1, 0 }, material = gr.material { kd = floor, ks = { 0.05, 0.05, 0.05 }, shininess = 10 } })
scene:add_child(gr.plane { normal = { 0, 0, 1 }, distance = -3.2, material = gr.material { kd = { 0.48, 0.55, 0.63 } } })

-- At a given time: height of the lowest point, velocity, and height of the ball in radii.
local function motion(b, seconds)
    local period = SECONDS / b[2]
    local flight = period - CONTACT
    local s = (seconds + b[3] * period) % period
    if s < CONTACT then -- the floor is a spring: half a wave
        local depth = math.sin(pi * s / CONTACT)
        return 0, 0, 1 - 0.34 * depth
    end
    s = s - CONTACT
    local v = GRAVITY * (flight / 2 - s)
    return GRAVITY * s * (flight - s) / 2, v, 1 + 0.035 * math.abs(v)
end

local lamp = gr.area_light({ -4.6, 8, 3.6 }, { 1.4, 0, 0 }, { 0, 0.5, 1.4 }, { 0.75, 0.72, 0.66 }, { 1, 0, 0 })
gr.frames {
    count = FPS * SECONDS, loop = true, pure = true, fps = FPS, shutter = { 0, 0.5 },
    draw = function(t)
        for _, b in ipairs(balls) do
            local low, v, tall = motion(b, t * SECONDS)
            local wide = 1 / sqrt(tall)
            b.node:reset():scale(wide, tall, wide):translate(b[4][1], low + b[1] * tall, b[4][2]):velocity(0, v, 0)
        end
        return {
            node = scene, width = 280, height = 200, eye = { 0.4, 2.5, 9.5 }, target = { 0.2, 1.55, 0 }, fov = 32, samples = 4, area_samples = 2,
            ambient = { 0.25, 0.26, 0.29 }, lights = { lamp, gr.light({ 6, 5, 9 }, { 0.22, 0.23, 0.27 }, { 1, 0, 0 }) },
        }
    end,
}
