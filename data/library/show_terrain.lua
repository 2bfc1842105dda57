-- TITLE: Library: an island
-- Ridged noise shaped into an island, worn down by 60,000 drops of rain; height and slope decide between sand, grass, rock
-- and snow; firs stand at scattered points in the grass.
-- Author: gray project

local studio = require 'studio'
local lsystem, noise, scatter, terrain = require 'lsystem', require 'noise', require 'scatter', require 'terrain'

local scene = gr.node 'island'
-- -D quick=true makes a draft.
local side, drops = quick and 40 or 320, quick and 400 or 60000
local land = terrain.noise { columns = side, rows = side, ridged = true, size = 0.34, octaves = 7, warp = 0.25, seed = 23 }
land = terrain.fit(land, 0, 1)
land = terrain.map(land, function(h, u, v)
    local r = math.sqrt((2 * u - 1) ^ 2 + (2 * v - 1) ^ 2) + 0.16 * noise.sum(3 * u, 7.7, 3 * v, 3)
    local shore = 1 - (math.max(0, r) / 0.93) ^ 2.2
    return h * h * 0.9 * math.max(0, shore) + 0.30 * shore - 0.05
end)
land = terrain.erode_rain(land, { drops = drops, seed = 3 })
land = terrain.erode_slopes(land, { steps = 6, talus = 0.012 })

local width, height = 20, 5.2
local verts, normals, faces = terrain.mesh(terrain.map(land, function(h) return math.max(h, -0.08) * height end),
    { width = width, depth = width })
-- The colour of the ground: sand at the water, grass where it is flat, rock where it is steep, snow above.
local function ground(p, s)
    local up, rough = s.normal.y, gr.noise(p * 1.7) * 0.5 + gr.noise(p * 4.3) * 0.3 + gr.noise(p * 11) * 0.2
    local rock = gr.mix({ 0.20, 0.18, 0.17 }, { 0.40, 0.36, 0.32 }, gr.smoothstep(-0.5, 0.5, rough + gr.noise(p * 30) * 0.3))
    local grass = gr.mix({ 0.10, 0.17, 0.05 }, { 0.27, 0.31, 0.11 }, gr.smoothstep(-0.5, 0.5, rough))
    local c = gr.mix(rock, grass, gr.smoothstep(0.60, 0.76, up + 0.2 * rough) * gr.smoothstep(2.6, 2.0, p.y + 0.5 * rough))
    c = gr.mix(c, { 0.88, 0.91, 0.96 }, gr.smoothstep(2.6, 3.0, p.y + 0.6 * rough) * gr.smoothstep(0.5, 0.66, up + 0.1 * rough))
    return gr.mix({ 0.62, 0.54, 0.37 }, c, gr.smoothstep(0.10, 0.24, p.y + 0.12 * rough))
end
scene:add_child(gr.vn_mesh(gr.material { kd = ground, ks = { 0, 0, 0 } }, verts, normals, faces, faces))

-- Firs: a stem and three skirts.
local firs, bark = {}, gr.material { kd = { 0.20, 0.15, 0.11 } }
for k = 1, 3 do
    local fir, green = gr.node 'fir', gr.material({ 0.07 + 0.03 * k, 0.20 + 0.04 * k, 0.09 }, { 0, 0, 0 }, 1)
    fir:add_child(gr.cone { from = { 0, 0, 0 }, from_radius = 0.05, to = { 0, 0.4, 0 }, radius = 0.04, material = bark })
    for skirt = 0, 2 do
        fir:add_child(gr.cone { from = { 0, 1.15 - 0.27 * skirt, 0 }, to = { 0, 0.68 - 0.25 * skirt, 0 }, from_radius = 0, radius = 0.2 + 0.07 * skirt, material = green })
    end
    firs[k] = fir
end
local places = scatter.mesh(verts, faces, {
    radius = quick and 0.8 or 0.17, seed = 9,
    where = function(p, n) return p[2] > 0.35 and p[2] < 1.9 and n[2] > 0.83 and noise.sum(p[1] * 0.5, 3, p[3] * 0.5, 3) > -0.12 end,
})
scene:add_child(scatter.place(places, firs, { scale = { 0.22, 0.42 }, lean = 0.1, sink = 0.03 }))

scene:add_child(gr.plane { normal = { 0, 1, 0 }, material = gr.rr_material({ 0.03, 0.16, 0.21 }, { 0.62, 0.68, 0.72 }, 300, 0.55, 0, 1.33) })

local sun = { -0.72, 0.52, 0.42 }
gr.render {
    node = scene, file = 'show_terrain.png', width = 960, height = 540, eye = { 3, 3.4, 19.5 }, target = { 0.2, 1.75, 0 }, fov = 34,
    ambient = { 0.34, 0.38, 0.46 }, background = gr.clear_sky { sun = sun, turbidity = 2.2, intensity = 0.9, ground = { 0.55, 0.66, 0.78 } },
    lights = { gr.sun_light { sun = sun, colour = { 0.86, 0.79, 0.66 } } }, tone = 'filmic', exposure = 0.45,
    fog = gr.height_fog { density = 0.006, base = 0, scale = 4, colour = { 0.66, 0.74, 0.84 } },
}
