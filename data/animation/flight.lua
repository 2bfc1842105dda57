-- TITLE: Animation: a flight around the island
-- A smaller version of the island in the library's demo. The camera follows keys on a closed spline and looks forwards.
-- Author: gray project

local noise, terrain = require 'noise', require 'terrain'

-- -D quick=true makes a draft.
local side = quick and 30 or 110
local land = terrain.noise { columns = side, rows = side, ridged = true, size = 0.34, octaves = 7, warp = 0.25, seed = 23 }
land = terrain.fit(land, 0, 1)
land = terrain.map(land, function(h, u, v)
    local r = math.sqrt((2 * u - 1) ^ 2 + (2 * v - 1) ^ 2) + 0.16 * noise.sum(3 * u, 7.7, 3 * v, 3)
    local shore = 1 - (math.max(0, r) / 0.93) ^ 2.2
    return h * h * 0.9 * math.max(0, shore) + 0.30 * shore - 0.05
end)
land = terrain.erode_rain(land, { drops = quick and 200 or 9000, seed = 3 })
land = terrain.erode_slopes(land, { steps = 4, talus = 0.012 })

local scene = gr.node 'island'
local width, height = 20, 5.2
local verts, normals, faces = terrain.mesh(terrain.map(land, function(h) return math.max(h, -0.08) * height end),
    { width = width, depth = width })
-- Sand, grass, rock and snow by height and slope.
local function ground(p, s)
    local jitter = noise.sum(p.x * 1.7, p.y * 1.7, p.z * 1.7, 3)
    local high, steep = p.y + 0.5 * jitter, s.normal.y + 0.12 * jitter
    local green = gr.mix({ 0.27, 0.42, 0.13 }, { 0.43, 0.52, 0.20 }, gr.smoothstep(-0.3, 0.4, jitter))
    local grey = gr.mix({ 0.36, 0.33, 0.31 }, { 0.50, 0.45, 0.40 }, gr.smoothstep(-0.3, 0.3, jitter))
    local land = gr.mix({ 0.80, 0.70, 0.49 }, green, gr.smoothstep(0.12, 0.3, p.y + 0.15 * jitter))
    land = gr.mix(land, grey, gr.max(gr.smoothstep(2.0, 2.5, high), gr.smoothstep(0.84, 0.74, steep)))
    return gr.mix(land, { 0.93, 0.95, 0.98 }, gr.smoothstep(2.6, 3.0, high) * gr.smoothstep(0.56, 0.66, steep))
end
scene:add_child(gr.vn_mesh { material = gr.material { kd = gr.fn(ground, 1) }, verts = verts, normals = normals, faces = faces, face_normals = faces })
scene:add_child(gr.plane { normal = { 0, 1, 0 }, material = gr.rr_material({ 0.03, 0.16, 0.21 }, { 0.62, 0.68, 0.72 }, 300, 0.55, 0, 1.33) })

-- Once around in SECONDS. Three additional keys before and after the loop close the spline.
local FPS, SECONDS, KEYS = 20, 4, 8
local keys = { curve = 'catmull' }
for k = -2, KEYS + 2 do
    local a = 2 * math.pi * k / KEYS
    local far, high = 10.9 + 1.2 * math.cos(2 * a), 2.6 + 0.7 * math.sin(a) + 0.4 * math.cos(3 * a)
    keys[#keys + 1] = { SECONDS * k / KEYS, {
        eye = { far * math.sin(a), high, far * math.cos(a) },
        target = { 3.2 * math.sin(a + 1.3), 1.3, 3.2 * math.cos(a + 1.3) },
    } }
end
local path = gr.keys(keys)

local sun = { -0.72, 0.52, 0.42 }
gr.frames {
    count = FPS * SECONDS, loop = true, pure = true, fps = FPS,
    draw = function(t)
        local show = path(t * SECONDS)
        show.node, show.width, show.height, show.fov = scene, 320, 180, 46
        show.ambient, show.tone = { 0.42, 0.46, 0.54 }, 'filmic'
        show.background = gr.clear_sky { sun = sun, turbidity = 2.2, intensity = 0.9, ground = { 0.55, 0.66, 0.78 } }
        show.lights = { gr.sun_light { sun = sun, colour = { 0.86, 0.79, 0.66 } } }
        show.fog = gr.height_fog { density = 0.006, base = 0, scale = 4, colour = { 0.66, 0.74, 0.84 } }
        return show
    end,
}
