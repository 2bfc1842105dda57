-- TITLE: Library: an island
-- Ridged noise shaped into an island, worn down by 40,000 drops of rain; its faces are sorted into sand, grass, rock and
-- snow by height and slope; firs stand at scattered points in the grass.
-- Author: gray project

local studio = require 'studio'
local lsystem, noise, scatter, terrain = require 'lsystem', require 'noise', require 'scatter', require 'terrain'

local scene = gr.node 'island'
-- -D quick=true makes a draft.
local side, drops = quick and 40 or 200, quick and 400 or 40000
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
local dice = require 'random'.new(5)
local looks = {
    sand = gr.material({ 0.78, 0.68, 0.47 }, { 0, 0, 0 }, 1), grass = gr.material({ 0.26, 0.40, 0.13 }, { 0, 0, 0 }, 1),
    meadow = gr.material({ 0.36, 0.46, 0.17 }, { 0, 0, 0 }, 1), rock = gr.material({ 0.42, 0.38, 0.34 }, { 0, 0, 0 }, 1),
    dark = gr.material({ 0.34, 0.31, 0.29 }, { 0, 0, 0 }, 1), snow = gr.material({ 0.92, 0.94, 0.97 }, { 0.2, 0.2, 0.2 }, 20),
}
local function kind(x, y, z, up)
    local jitter = 0.25 * noise.sum(x, y, z, 3) + dice:range(-0.05, 0.05)
    if y < 0.16 + 0.15 * jitter then return 'sand' end
    if y > 2.75 + 0.9 * jitter and up > 0.62 then return 'snow' end
    if up < 0.80 + 0.2 * jitter or y > 2.3 + jitter then return jitter > 0 and 'rock' or 'dark' end
    return jitter > 0 and 'meadow' or 'grass'
end
for name, mesh in pairs(terrain.split(verts, normals, faces, kind)) do
    scene:add_child(gr.vn_mesh(looks[name], table.unpack(mesh)))
end

-- Firs: a stem and three skirts.
local firs = {}
for k = 1, 3 do
    local fir, green = gr.node 'fir', gr.material({ 0.07 + 0.03 * k, 0.20 + 0.04 * k, 0.09 }, { 0, 0, 0 }, 1)
    fir:add_child(gr.cone { from = { 0, 0, 0 }, from_radius = 0.05, to = { 0, 0.4, 0 }, radius = 0.04, material = looks.dark })
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
    lights = { gr.sun_light { sun = sun, colour = { 0.86, 0.79, 0.66 } } }, tone = 'filmic',
    fog = gr.height_fog { density = 0.006, base = 0, scale = 4, colour = { 0.66, 0.74, 0.84 } },
}
