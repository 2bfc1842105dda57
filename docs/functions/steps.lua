-- The pictures of the tutorial in docs/functions.md, one for each step; docs/functions/make_pictures.sh renders them.
-- Author: gray project

local red, white = gr.vec(0.75, 0.08, 0.06), gr.vec(0.95, 0.93, 0.88)

--- A ball and a box of a material on a floor.
local function pair(material)
    local scene = gr.node 'pair'
    scene:add_child(gr.sphere { material = material }:translate(-1.15, 1, 0))
    scene:add_child(gr.box { min = { -0.8, -0.8, -0.8 }, max = { 0.8, 0.8, 0.8 }, material = material }:rotate('y', 28):translate(1.2, 0.8, 0))
    return scene
end

local function rings(p)
    local far = math.sqrt(p.x ^ 2 + p.z ^ 2)
    return gr.mix(red, white, gr.step(0, math.sin(20 * far)))
end

local function checker(p)
    local q = 3 * p + 0.01
    if (math.floor(q.x) + math.floor(q.y) + math.floor(q.z)) % 2 < 1 then return white end
    return { 0.1, 0.2, 0.45 }
end

local function marble(p)
    local bent = p.x + 0.6 * gr.turbulence(2 * p, 6)
    local vein = math.abs(math.sin(5 * bent)) ^ 0.35
    return gr.mix({ 0.16, 0.18, 0.22 }, { 0.93, 0.92, 0.90 }, vein)
end

local function scales(p)
    local f1, f2 = gr.cells(5 * p)
    return gr.smoothstep(0, 0.45, f2 - f1)
end
local function skin(p)
    return gr.mix({ 0.10, 0.16, 0.05 }, { 0.35, 0.50, 0.16 }, scales(p))
end

local function slots(p, s)
    return gr.step(0.35, math.abs((10 * s.u) % 1 - 0.5) + math.abs((6 * s.v) % 1 - 0.5))
end

local function lumps(p)
    return 0.35 * gr.turbulence(1.6 * p, 5)
end

local function gyroid(p)
    local q = 7 * p
    local wave = math.sin(q.x) * math.cos(q.y) + math.sin(q.y) * math.cos(q.z) + math.sin(q.z) * math.cos(q.x)
    return math.max(math.abs(wave) - 0.35, p:length() - 1)
end

local function evening(d)
    local up = gr.clamp(d.y, 0, 1)
    local blue = gr.mix({ 0.95, 0.62, 0.35 }, { 0.16, 0.24, 0.50 }, up ^ 0.5)
    local q = gr.vec(d.x, 0, d.z) / (up + 0.15)
    return gr.mix(blue, { 0.98, 0.80, 0.70 }, gr.smoothstep(0.1, 0.7, gr.noise(1.5 * q) + 0.5 * gr.noise(3 * q)))
end

local function shiny(kd) return gr.material { kd = kd, ks = { 0.3, 0.3, 0.3 }, shininess = 40 } end
local function alone(node)
    local scene = gr.node 'alone'
    scene:add_child(node:translate(0, 1, 0))
    return scene
end

-- Displacement moves the vertices of meshes, so a ball of triangles replaces the sphere.
local verts, _, faces = require('polyhedra').geodesic(3)
local function strata(p)
    return gr.mix({ 0.30, 0.25, 0.20 }, { 0.72, 0.64, 0.52 }, gr.smoothstep(1.0, 1.25, p:length()))
end
local rock = gr.mesh(gr.material { kd = strata }, verts, faces)
rock:displace(lumps, 0.03)

local steps = {
    { 'rings', pair(shiny(rings)) },
    { 'checker', pair(shiny(checker)) },
    { 'marble', pair(shiny(marble)) },
    { 'bump', pair(gr.material { kd = skin, ks = { 0.4, 0.4, 0.4 }, shininess = 30, bump = gr.bump(scales, 0.05) }) },
    { 'holes', pair(gr.material { kd = { 0.80, 0.62, 0.25 }, opacity = slots, two_sided = true }) },
    { 'displace', alone(rock) },
    { 'implicit', alone(gr.implicit { f = gyroid, radius = 1.01, material = gr.material { kd = { 0.80, 0.55, 0.30 }, ks = { 0.3, 0.3, 0.3 }, shininess = 40, two_sided = true } }) },
    { 'sky', alone(gr.sphere { material = gr.rr_material({ 0.05, 0.05, 0.06 }, { 0.9, 0.9, 0.9 }, 100, 0.9, 0, 1) }), evening },
}
for _, step in ipairs(steps) do
    local scene = step[2]
    scene:add_child(gr.plane { normal = { 0, 1, 0 }, material = gr.material { kd = { 0.66, 0.65, 0.62 } } })
    gr.render {
        node = scene, file = 'docs/functions/' .. step[1] .. '.png', width = 240, height = 150, eye = { 0, 1.9, 6.6 }, target = { 0, 1.02, 0 }, fov = 28,
        ambient = { 0.28, 0.29, 0.32 }, background = step[3] or { 0.78, 0.82, 0.86 }, samples = 4,
        lights = { gr.directional_light { direction = { 0.55, -0.75, -0.65 }, colour = { 0.85, 0.82, 0.75 } } },
    }
end
