-- TITLE: Functions: a landscape
-- A valley: a height field from one function of two numbers. The same function colours it: meadows, rock on slopes, and
-- snow at the top. The sky with its clouds is a function of the direction.
-- Author: gray project

-- Ridged noise with sharp crests: an octave is lower where the previous one is low.
local function mountains(x, z)
    local sum, weight, size, frequency = 0, 1, 1, 1
    for k = 1, 9 do
        local ridge = 1 - math.abs(gr.noise(x * frequency, 3.7 * k, z * frequency))
        ridge = ridge * ridge * weight
        weight = gr.clamp(ridge * 1.6, 0, 1)
        sum, frequency, size = sum + ridge * size, frequency * 2.07, size * 0.48
    end
    return sum
end

-- The point is {x, 0, z}, both from 0 to 1; a valley runs away from the camera.
local function height(p)
    local x = p.x - 0.5 - 0.06 * math.sin(9 * p.z)
    local valley = gr.smoothstep(0.02, 0.42, math.abs(x))
    local rough = mountains(p.x * 4.1 + 2, p.z * 4.1)
    return 0.012 + valley * 0.088 * rough + 0.009 * rough
end

local land = gr.height_field { f = height, columns = quick and 60 or 1400, rows = quick and 60 or 1400, smooth = true, floor = -0.1 }
local function ground(p, s)
    local h, up = p.y, s.normal.y
    local jitter = gr.noise(p * 30) * 0.5 + gr.noise(p * 90) * 0.25 + gr.noise(p * 400) * 0.2
    local meadow = gr.mix({ 0.09, 0.15, 0.045 }, { 0.30, 0.32, 0.13 }, gr.smoothstep(-0.6, 0.7, jitter + gr.noise(p * 9)))
    local rock = gr.mix({ 0.17, 0.155, 0.15 }, { 0.44, 0.40, 0.36 }, gr.smoothstep(-0.5, 0.5, 0.6 * gr.noise(p * 60) + jitter))
    local c = gr.mix(meadow, rock, gr.max(gr.smoothstep(0.74, 0.62, up + 0.1 * jitter), gr.smoothstep(0.085, 0.115, h + 0.02 * jitter)))
    return gr.mix(c, { 0.93, 0.95, 0.99 }, gr.smoothstep(0.11, 0.135, h + 0.02 * jitter) * gr.smoothstep(0.52, 0.66, up))
end
land:set_material(gr.material { kd = ground })
land:translate(-0.5, 0, -1):scale(10, 10, 10)

-- Blue above, pale at the horizon, clouds on a plane overhead.
local function sky(d)
    local up = gr.max(d.y, 0.0)
    local blue = gr.mix({ 0.80, 0.86, 0.92 }, { 0.22, 0.44, 0.80 }, gr.smoothstep(0.0, 0.55, up ^ 0.7))
    local q = gr.vec(d.x, 0.3, d.z) / (up + 0.12)
    local puff = gr.noise(q * 1.3) + 0.5 * gr.noise(q * 2.7 + 4) + 0.25 * gr.noise(q * 5.3 + 8) + 0.12 * gr.noise(q * 11 + 1)
    return gr.mix(blue, { 0.97, 0.97, 0.96 }, 0.85 * gr.smoothstep(0.05, 0.75, puff) * gr.smoothstep(0.02, 0.18, up))
end

local scene = gr.node 'valley'
scene:add_child(land)
-- The lake in the middle of the valley.
scene:add_child(gr.plane { normal = { 0, 1, 0 }, distance = 0.25, material = gr.rr_material({ 0.03, 0.10, 0.12 }, { 0.7, 0.7, 0.7 }, 200, 0.6, 0, 1.33) })
gr.render {
    node = scene, file = 'landscape.png', width = 640, height = 384, eye = { 0.35, 1.35, 0.0 }, target = { -0.15, 0.75, -5 }, fov = 46,
    ambient = { 0.20, 0.25, 0.34 }, background = sky, tone = 'filmic', exposure = 0.35,
    lights = { gr.directional_light { direction = { 0.62, -0.44, -0.60 }, colour = { 1.15, 0.98, 0.76 } } },
    fog = gr.height_fog { density = 0.035, base = 0, scale = 1.5, colour = { 0.74, 0.81, 0.89 } },
}
