-- TITLE: Functions: quaternion Julia sets
-- q = q^2 + c for quaternions: two solids whose function is an estimate of the distance; a corner is cut out of one of them.
-- Source: J. Hart, D. Sandin and L. Kauffman, "Ray Tracing Deterministic 3-D Fractals", SIGGRAPH 1989.
-- Author: gray project

local sdf = require 'sdf'
local steps = quick and 6 or 9 -- -D quick=true makes a draft

--- The distance from the filled set of c where the last component of q is 0, less the thickness of its skin. A point that
-- has escaped stays where it is.
local function julia(a, b, c, d)
    return function(p)
        local _, x, y, z, w, slope = gr.loop(steps, 1, p.x, p.y, p.z, 0.0, 1.0, function(_, _, x, y, z, w, slope)
            local square = x * x + y * y + z * z + w * w
            if square > 256 then return 0, x, y, z, w, slope end
            slope = 2 * math.sqrt(square) * slope
            return 1, x * x - y * y - z * z - w * w + a, 2 * x * y + b, 2 * x * z + c, 2 * x * w + d, slope
        end)
        local square = x * x + y * y + z * z + w * w
        return gr.max(0.25 * math.log(square) * math.sqrt(square) / slope, 0.0) - 0.001 -- nothing is known of the inside
    end
end

local function solid(f, from, to)
    local function colour(p)
        local on_cut = gr.where(gr.min(p.y, p.z) + 1e-5, gr.where(1e-5 - gr.min(p.y, p.z), 1, 0), 0)
        return gr.mix(gr.mix(from, to, gr.smoothstep(0.2, 1.25, gr.length(p))), { 0.85, 0.80, 0.70 }, on_cut)
    end
    local material = gr.material { kd = colour, ks = { 0.4, 0.4, 0.4 }, shininess = 60 }
    return gr.implicit { f = f, radius = 1.6, distance = true, material = material }
end

local scene = gr.node 'julia'
local corner = sdf.translate(sdf.box { 2, 1, 1 }, { 0, 1, 1 })
local whole = solid(julia(-0.2, 0.6, 0.2, 0.2), gr.vec(0.75, 0.35, 0.10), gr.vec(0.95, 0.75, 0.40))
local cut = solid(sdf.difference(julia(-0.08, 0.0, -0.83, -0.025), corner), gr.vec(0.15, 0.30, 0.60), gr.vec(0.60, 0.80, 0.90))
scene:add_child(whole:translate(-1.25, 0, 0))
scene:add_child(cut:translate(1.25, 0, 0))
scene:add_child(gr.plane { normal = { 0, 1, 0 }, distance = -1.1, material = gr.material { kd = { 0.55, 0.55, 0.58 } } })

gr.render {
    node = scene, file = 'julia.png', width = 640, height = 360, eye = { 0.3, 2.2, 5.6 }, target = { 0, -0.1, 0 }, fov = 32,
    ambient = { 0.32, 0.33, 0.36 }, background = { 0.75, 0.80, 0.88 },
    lights = { gr.directional_light { direction = { -0.5, -1, -0.6 }, colour = { 0.95, 0.92, 0.85 } } },
}
