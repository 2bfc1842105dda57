-- TITLE: Library: lathe, sweep, loft and patches
-- A vase turned on the lathe, a bottle lofted from a square over a star to a circle, a twisted column swept along a line, a
-- bowl through a net of points and a cushion of a B-spline net.
-- Author: gray project

local studio = require 'studio'
local bezier, colour, lathe, loft, sweep = require 'bezier', require 'colour', require 'lathe', require 'loft', require 'sweep'

local scene = gr.node 'curves'
local function at(x, y, z, turn, node) studio.place(scene, node, x, y, z, turn) end

local vase = lathe.spline({ { 0, 0 }, { 0.52, 0 }, { 0.52, 0 }, { 0.62, 0.12 }, { 1.02, 0.95 }, { 0.85, 1.75 }, { 0.40, 2.35 }, { 0.36, 2.7 },
    { 0.58, 3.05 }, { 0.55, 3.07 }, { 0.30, 2.7 }, { 0.34, 2.35 }, { 0, 2.2 } }, 12)
at(-4.7, 0, 0, 0, gr.vn_mesh(studio.glaze { 0.10, 0.32, 0.42 }, lathe.turn(vase, 96)))

local body = { loft.mesh({
    loft.superellipse(0.85, 0.85, 6), loft.superellipse(0.92, 0.92, 5), loft.polygon(8, 1.0, 0.72, 22), loft.polygon(8, 0.62, 0.46, 30),
    loft.superellipse(0.24, 0.24), loft.superellipse(0.30, 0.30),
}, { heights = { 0, 0.35, 1.5, 2.3, 2.9, 3.3 }, around = 192, along = 14 }) }
at(-2.0, 0, -0.4, 20, gr.vn_mesh(studio.glaze { 0.34, 0.05, 0.13 }, table.unpack(body)))

-- A column of four leaves that turns as it rises, thicker in its middle.
local line = {}
for k = 0, 60 do line[k + 1] = { 0, 3.4 * k / 60, 0 } end
local leaves = {}
for k = 0, 47 do
    local a = 2 * math.pi * k / 48
    local r = 0.34 + 0.12 * math.cos(4 * a)
    leaves[k + 1] = { r * math.cos(a), r * math.sin(a) }
end
local column = { sweep.profile(line, leaves, { twist = function(t) return 300 * t end, scale = function(t) return 1 + 0.35 * math.sin(math.pi * t) end }) }
at(0.4, 0, -1.2, 0, gr.vn_mesh(studio.glaze { 0.82, 0.76, 0.62 }, table.unpack(column)))
local spring = {}
for k = 0, 400 do
    local a = 2 * math.pi * k / 80
    spring[k + 1] = { 0.9 * math.cos(a), 0.14 + 0.9 * k / 400, 0.9 * math.sin(a) }
end
at(-3.2, 0, 2.2, 0, gr.vn_mesh(studio.copper, sweep.tube(spring, 0.085, 16)))

-- A bowl with a waving rim: its points lie on the surface.
local net = {}
for j = 0, 5 do
    net[j + 1] = {}
    for i = 0, 11 do
        local a, t = 2 * math.pi * i / 12, j / 5
        local r = 0.15 + 1.25 * t ^ 0.7
        net[j + 1][i + 1] = { r * math.cos(a), 0.04 + 1.1 * t * t + 0.16 * t * t * math.cos(3 * a), r * math.sin(a) }
    end
end
local control, patches = bezier.through(net, true, false)
local bowl = gr.material { kd = { 0.75, 0.42, 0.12 }, ks = { 0.4, 0.4, 0.4 }, shininess = 80, two_sided = true }
at(2.6, 0, 0.9, 10, gr.patch { points = control, patches = patches, tolerance = 0.001, material = bowl })

-- A cushion: a closed B-spline net whose ends meet; the surface passes through a point that is given three times.
local cushion = {}
for j, row in ipairs { { 0, -0.3 }, { 0, -0.3 }, { 0, -0.3 }, { 1.5, -0.4 }, { 2.1, 0 }, { 1.5, 0.4 }, { 0, 0.3 }, { 0, 0.3 }, { 0, 0.3 } } do
    cushion[j] = {}
    for i = 0, 3 do
        local a = 2 * math.pi * (i + 0.5) / 4
        cushion[j][i + 1] = { row[1] * math.cos(a), 0.32 + 0.95 * row[2], row[1] * math.sin(a) }
    end
end
control, patches = bezier.b_spline(cushion, true, false)
local verts, normals, faces, face_normals = bezier.mesh(control, patches, 14, true)
at(5.0, 0, -0.2, 25, gr.vn_mesh(studio.matt { 0.45, 0.22, 0.44 }, verts, normals, faces, face_normals))

studio.render { node = scene, file = 'show_curves.png', eye = { 0.3, 5.2, 17.5 }, target = { 0.1, 1.35, 0 }, fov = 22, floor = { 0.09, 0.20, 0.32 },
    key = { 10, 10, 8 }, lamp = 3, light = { 1.7, 1.35, 0.9 } }
