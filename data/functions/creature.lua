-- TITLE: Functions: a creature of smooth unions
-- Body, legs, ears and tail are balls and capsules joined by one function; spots and eyes are patterns in Lua.
-- Author: gray project

local patterns, sdf = require 'patterns', require 'sdf'

-- One half; the other is its mirror image.
local half = sdf.mirror(sdf.smooth_union(0.12,
    sdf.capsule({ 0.30, 0.55, 0.45 }, { 0.36, 0.10, 0.50 }, 0.17, 0.13), sdf.capsule({ 0.30, 0.55, -0.5 }, { 0.36, 0.10, -0.55 }, 0.19, 0.14),
    sdf.capsule({ 0.22, 1.42, 0.86 }, { 0.42, 1.86, 0.72 }, 0.12, 0.03), sdf.translate(sdf.sphere(0.13), { 0.38, 0.08, 0.58 }),
    sdf.translate(sdf.sphere(0.14), { 0.38, 0.08, -0.48 })))
local middle = sdf.smooth_union(0.25,
    sdf.translate(sdf.ellipsoid { 0.48, 0.42, 0.85 }, { 0, 0.72, 0 }), sdf.translate(sdf.sphere(0.40), { 0, 1.22, 0.88 }),
    sdf.translate(sdf.ellipsoid { 0.22, 0.17, 0.25 }, { 0, 1.08, 1.22 }),
    sdf.capsule({ 0, 0.85, -0.7 }, { 0, 1.15, -1.25 }, 0.12, 0.07), sdf.capsule({ 0, 1.15, -1.25 }, { 0, 1.6, -1.3 }, 0.07, 0.10))
local body = sdf.smooth_difference(0.05, sdf.smooth_union(0.16, middle, half), sdf.capsule({ -0.14, 0.98, 1.44 }, { 0.14, 0.98, 1.44 }, 0.035))

local eyes = sdf.mirror(sdf.translate(sdf.sphere(0.075), { 0.16, 1.34, 1.22 }))

local function skin(p)
    local belly = gr.smoothstep(0.45, 0.75, p.y + 0.1 * gr.noise(p * 3))
    local spots = patterns.spots(p * 3.2, 0.36, 0.3) * belly
    return gr.mix(gr.mix(gr.vec(0.85, 0.80, 0.60), gr.vec(0.35, 0.55, 0.30), belly), gr.vec(0.12, 0.28, 0.22), spots)
end
local function grass(p) return gr.mix(gr.vec(0.20, 0.34, 0.10), gr.vec(0.45, 0.50, 0.20), patterns.clouds(p * 1.5, 6)) end

local scene = gr.node 'scene'
scene:add_child(gr.implicit {
    f = body, bounds = { { -0.8, -0.08, -1.6 }, { 0.8, 2, 1.6 } },
    material = gr.material { kd = skin, ks = { 0.25, 0.25, 0.25 }, shininess = 50, bump = gr.bump(function(p) return gr.noise(p * 40) end, 0.004) },
})
scene:add_child(gr.implicit { f = eyes, bounds = { { -0.3, 1.2, 1.1 }, { 0.3, 1.5, 1.4 } }, material = gr.material({ 0.02, 0.02, 0.02 }, { 0.9, 0.9, 0.9 }, 200) })
scene:add_child(gr.plane { normal = { 0, 1, 0 }, distance = -0.04, material = gr.material { kd = grass } })

gr.render {
    node = scene, file = 'creature.png', width = 600, height = 400, eye = { 4.2, 2.2, 4.6 }, target = { 0, 0.85, 0.1 }, fov = 27,
    ambient = { 0.28, 0.30, 0.34 }, background = { 0.62, 0.76, 0.92 },
    lights = { gr.light({ 4, 8, 6 }, { 0.8, 0.76, 0.68 }, { 1, 0, 0 }) },
}
