-- TITLE: Functions: a creature of smooth unions
-- OPTIONS: --spp 6
-- Body, legs, ears and tail are balls and capsules joined by one function; its spots are a pattern in Lua. The meadow is a
-- height field by a function with copies of a few tufts of grass.
-- Author: gray project

local patterns, random, sdf = require 'patterns', require 'random', require 'sdf'

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

local function skin(p)
    local belly = gr.smoothstep(0.45, 0.75, p.y + 0.1 * gr.noise(p * 3))
    local spots = patterns.spots(p * 3.2, 0.36, 0.3) * belly
    return gr.mix(gr.mix(gr.vec(0.80, 0.68, 0.42), gr.vec(0.22, 0.46, 0.14), belly), gr.vec(0.035, 0.16, 0.10), spots)
end
local scene = gr.node 'scene'
scene:add_child(gr.implicit {
    f = body, lipschitz = 1.2, bounds = { { -0.8, -0.08, -1.6 }, { 0.8, 2, 1.6 } },
    material = gr.openpbr_material { base_color = skin, specular_roughness = 0.38, coat_weight = 0.3, coat_roughness = 0.25,
        geometry_normal = gr.bump(function(p) return gr.noise(p * 40) end, 0.004) },
})
-- The eyes sit in the head: two thirds of each ball are inside.
local eye = gr.openpbr_material { base_color = { 0.012, 0.009, 0.007 }, specular_roughness = 0.06, coat_weight = 1 }
for side = -1, 1, 2 do scene:add_child(gr.sphere { centre = { 0.165 * side, 1.345, 1.185 }, radius = 0.075, material = eye }) end

-- the meadow
local function hill(x, z) return 0.5 * gr.noise(x * 0.13 + 3, 0, z * 0.13) * gr.smoothstep(1.5, 6, gr.length(gr.vec(x, 0, z))) - 0.03 end
local soil = gr.openpbr_material { specular_weight = 0, base_color = function(p) return gr.mix(gr.vec(0.16, 0.23, 0.04), gr.vec(0.20, 0.24, 0.05), patterns.clouds(p * 1.5, 4)) end }
scene:add_child(gr.height_field { material = soil, columns = 200, smooth = true, open = true, f = function(p) return hill((p.x - 0.5) * 60, (p.z - 0.5) * 60) / 60 end }
    :translate(-0.5, 0, -0.5):scale(60, 60, 60))
local dice = random.new(3)
local blade = gr.openpbr_material { specular_roughness = 0.5, base_color = function(p) return gr.mix(gr.vec(0.07, 0.20, 0.02), gr.vec(0.34, 0.40, 0.08), gr.clamp(p.y * 4, 0, 1)) end }
local tufts = {}
for kind = 1, 6 do
    local verts, faces = {}, {}
    for k = 0, 5 * 249, 5 do
        local x, z, turn, tall, lean = dice:range(-0.3, 0.3), dice:range(-0.3, 0.3), dice:range(0, 6.28), dice:range(0.12, 0.26), dice:range(0.02, 0.14)
        local c, s = math.cos(turn), math.sin(turn)
        for j, w in ipairs { 0.007, 0.006 } do
            local out, y = 0.3 * lean * (j - 1), -0.02 + (0.6 * tall + 0.02) * (j - 1)
            verts[#verts + 1] = { x + out * c - w * s, y, z + out * s + w * c }
            verts[#verts + 1] = { x + out * c + w * s, y, z + out * s - w * c }
        end
        verts[#verts + 1] = { x + lean * c, tall, z + lean * s }
        faces[#faces + 1] = { k, k + 1, k + 3, k + 2 }
        faces[#faces + 1] = { k + 2, k + 3, k + 4 }
    end
    tufts[kind] = gr.mesh(blade, verts, faces)
end
-- Squares of grass beside each other: a ray meets few of them, where tufts at random lie over each other.
for x = -12.7, 5, 0.6 do
    for z = -14.7, 4.4, 0.6 do
        scene:add_child(gr.node { children = { tufts[dice:whole(1, 6)] } }:rotate('y', 90 * dice:whole(0, 3)):scale(1, dice:range(0.7, 1.2), 1):translate(x, hill(x, z), z))
    end
end

local sun = gr.vec(0.2, 0.42, 0.75):normalize()
local sky = gr.sky_gradient { { -1, 0.10, 0.12, 0.08 }, { 0, 0.62, 0.74, 0.86 }, { 0.3, 0.25, 0.46, 0.82 }, { 1, 0.10, 0.24, 0.60 } }
gr.render {
    node = scene, file = 'creature.png', width = 540, height = 360, eye = { 4.0, 1.15, 4.9 }, target = { 0, 0.82, 0.1 }, fov = 27,
    aperture = 0.03, focus_point = { 0.2, 1.2, 1.1 },
    integrator = 'path', denoise = true, tone = 'filmic', exposure = -0.45, max_depth = 4, clamp = 12, background = sky,
    lights = { gr.spherical_light { position = sun * 50, radius = 1.2, emission = { 2300, 1800, 1150 } }, gr.sky_light { sky = sky } },
}
