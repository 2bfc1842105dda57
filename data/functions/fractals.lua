-- TITLE: Functions: fractals
-- gr.loop repeats a step for each point until it ends: the floor is the Mandelbrot set, the balls are Julia sets. The step is
-- recorded once, so the number of steps costs no memory, and points far from a set need few of them.
-- Author: gray project

local steps = quick and 100 or 400 -- -D quick=true makes a draft

--- Repeats z = z^2 + c, and returns a smooth number of steps until |z| > 2^8; 0 in the set.
-- See Peitgen and Richter, "The Beauty of Fractals", 1986.
local function escape(x, y, cx, cy)
    local inside, k
    inside, x, y, k = gr.loop(steps, 1, x, y, 0, function(_, _, x, y, k)
        if x * x + y * y > 65536 then return 0, x, y, k end
        return 1, x * x - y * y + cx, 2 * x * y + cy, k + 1
    end)
    local smooth = k - math.log(gr.max(math.log(x * x + y * y + 1e-300), 1e-3) / math.log(65536.0), 2)
    return gr.where(inside, 0, gr.max(smooth, 0.5))
end

--- A colour for a number of steps: black in the set, then through the colours in order.
local function colours(k, first, second)
    local t = math.log(k + 1)
    local wave = 0.5 - 0.5 * gr.vec(math.cos(first * t), math.cos(first * t + 0.7), math.cos(first * t + 1.5))
    return gr.step(0.25, k) * gr.mix(wave * wave, second, 0.25 * gr.smoothstep(0, 6, t))
end

local function mandelbrot(p)
    return colours(escape(0.0, 0.0, 0.42 * p.x - 0.62, 0.42 * p.z), 2.6, gr.vec(1.0, 0.75, 0.30))
end

local function ball(cx, cy, first, second)
    local function julia(p, s)
        return colours(escape(1.25 * p.x, 1.25 * p.y, cx, cy), first, second)
    end
    return gr.sphere { radius = 1, material = gr.material { kd = julia, ks = { 0.5, 0.5, 0.5 }, shininess = 120, reflect = 0.12 } }
end

local scene = gr.node 'fractals'
scene:add_child(gr.plane { normal = { 0, 1, 0 }, material = gr.material { kd = mandelbrot, reflect = 0.15 } })
scene:add_child(ball(-0.8, 0.156, 3.0, gr.vec(0.2, 0.5, 1.0)):scale(0.62, 0.62, 0.62):translate(-2.05, 0.62, -0.9))
scene:add_child(ball(-0.7269, 0.1889, 2.2, gr.vec(1.0, 0.4, 0.2)):scale(0.8, 0.8, 0.8):translate(0.15, 0.8, -2.2))
scene:add_child(ball(0.285, 0.01, 2.6, gr.vec(0.3, 1.0, 0.5)):scale(0.5, 0.5, 0.5):translate(2.0, 0.5, -0.6))

gr.render {
    node = scene, file = 'fractals.png', width = 640, height = 400, eye = { 0.2, 2.7, 4.4 }, target = { 0, 0.15, -0.4 }, fov = 42,
    ambient = { 0.30, 0.30, 0.32 }, background = function(d)
        return gr.mix({ 0.75, 0.80, 0.88 }, { 0.14, 0.22, 0.42 }, gr.clamp(d.y, 0, 1) ^ 0.6)
    end,
    lights = { gr.directional_light { direction = { -0.5, -1, -0.45 }, colour = { 1.0, 0.96, 0.88 } } },
}
