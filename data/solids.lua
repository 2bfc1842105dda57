-- TITLE: Every shape, with its name
-- Forty of them on stairs: flat ones, quadrics, tori, superellipsoids, surfaces of revolution, prisms, sweeps, height
-- fields, blobs, hair, patches and meshes. The ground is an infinite plane.
-- Author: gray project

local colour, knot, noise, polyhedra, text = require 'colour', require 'knot', require 'noise', require 'polyhedra', require 'text'

local cos, sin, pi = math.cos, math.sin, math.pi
local ivory = gr.material({0.80, 0.77, 0.71}, {0.12, 0.12, 0.12}, 30)
local knife = gr.material({0.93, 0.90, 0.84}, {0.1, 0.1, 0.1}, 20)
local ink = gr.material({0.15, 0.16, 0.20}, {0.1, 0.1, 0.1}, 20)
local ground = gr.material({0.44, 0.47, 0.50}, {0.05, 0.05, 0.05}, 10)

local function ring_of(n, radius, x, z)
    local out = {}
    for k = 0, n - 1 do out[k + 1] = {(x or 0) + radius * cos(2 * pi * k / n), (z or 0) + radius * sin(2 * pi * k / n)} end
    return out
end

--- Corners of a star as pairs.
local function star(tips, far, near)
    local points = {}
    for k = 0, 2 * tips - 1 do
        local angle, r = pi * (k / tips + 0.5), k % 2 == 0 and far or near
        points[k + 1] = {r * cos(angle), r * sin(angle)}
    end
    return points
end

--- A star with a round hole, as outlines of a polygon.
local star_points, star_outlines = {}, {{}, {}}
for _, p in ipairs(star(7, 0.95, 0.58)) do
    star_points[#star_points + 1] = {p[1], p[2], 0}
    table.insert(star_outlines[1], #star_points - 1)
end
for _, p in ipairs(ring_of(32, 0.3)) do
    star_points[#star_points + 1] = {p[1], p[2], 0}
    table.insert(star_outlines[2], #star_points - 1)
end

local hills = {}
for j = 1, 64 do
    hills[j] = {}
    for i = 1, 64 do
        local u, v = i / 32 - 1, j / 32 - 1
        local fall = math.max(0, 1 - u ^ 4) * math.max(0, 1 - v ^ 4)
        hills[j][i] = fall * (0.25 + 0.42 * noise.sum(2.1 * u + 3, 0.5, 2.1 * v + 1, 5))
    end
end

local patch = {}
for j = 0, 3 do
    for i = 0, 3 do
        local x, z = i / 1.5 - 1, j / 1.5 - 1
        patch[#patch + 1] = {0.85 * x, 0.55 + 0.55 * x * x - 0.6 * z * z + 0.2 * z, 0.85 * z}
    end
end

local tuft
local function hair(m)
    tuft = gr.node 'tuft'
    for k = 0, 139 do
        local a, r = k * 2.39996, 0.52 * math.sqrt((k + 0.5) / 140)
        local x, z, tall = r * cos(a), r * sin(a), 1.5 - 0.5 * r + 0.12 * sin(k * 3.1)
        tuft:add_child(gr.curve {spline = 'bezier', widths = {0.04, 0.04, 0.03, 0.006}, material = m,
            points = {{x, 0, z}, {1.1 * x, 0.5 * tall, 1.1 * z}, {1.5 * x, tall, 1.5 * z}, {2.2 * x + 0.15 * cos(a), 0.88 * tall, 2.2 * z}}})
    end
    return tuft
end

-- Each entry: its name and its maker; the shape stands on y = 0 and is about 1.7 high.
local show = {
    {
        {'sphere', function(m) return gr.sphere {centre = {0, 0.85, 0}, radius = 0.85, material = m} end},
        {'ellipsoid', function(m) return gr.ellipsoid {centre = {0, 0.55, 0}, radii = {1, 0.55, 0.7}, material = m} end},
        {'cube', function(m) return gr.cube(m):translate(-0.5, 0, -0.5):scale(1.25, 1.25, 1.25):rotate('y', 30) end},
        {'box', function(m) return gr.box {min = {-0.95, 0, -0.4}, max = {0.95, 1.2, 0.4}, material = m}:rotate('y', -25) end},
        {'cylinder', function(m) return gr.cylinder {to = {0, 1.5, 0}, from = {0, 0, 0}, radius = 0.7, material = m} end},
        {'open tube', function(m)
            return gr.cylinder {radius = 0.55, open = true, material = m}:rotate('x', 62):rotate('y', 24):translate(0, 0.78, 0)
        end},
        {'cone', function(m) return gr.cone {from = {0, 1.7, 0}, to = {0, 0, 0}, from_radius = 0, radius = 0.85, material = m} end},
        {'frustum', function(m)
            return gr.cone {from = {0, 0, 0}, from_radius = 0.85, to = {0.25, 1.4, 0}, radius = 0.4, material = m}
        end},
    },
    {
        {'torus', function(m) return gr.torus {major = 0.68, minor = 0.27, material = m}:rotate('x', 38):translate(0, 0.7, 0) end},
        {'spindle torus', function(m) return gr.torus {major = 0.32, minor = 0.58, material = m}:translate(0, 0.58, 0) end},
        {'paraboloid', function(m) return gr.paraboloid {radius = 0.75, height = 1.4, open = true, material = m}:rotate('x', 10) end},
        {'one sheet', function(m) return gr.hyperboloid {waist = 0.35, radius = 0.8, height = 0.75, material = m}:translate(0, 0.75, 0) end},
        {'two sheets', function(m) return gr.hyperboloid {gap = 0.2, radius = 0.8, height = 0.75, material = m}:translate(0, 0.75, 0) end},
        {'quadric', function(m)
            return gr.quadric {xx = 1, zz = -1, y = 1, constant = -0.1, min = {-0.75, -0.75, -0.75}, max = {0.75, 0.85, 0.75}, material = m}
                :rotate('y', 35):translate(0, 0.75, 0)
        end},
        {'half-space', function(m)
            return gr.difference('half', gr.sphere(m), gr.plane {normal = {-0.5, -0.35, -0.75}, distance = -0.2, material = knife})
                :scale(0.85, 0.85, 0.85):translate(0, 0.85, 0)
        end},
        {'superellipsoid', function(m)
            return gr.superellipsoid {e = 0.3, n = 0.3, material = m}:scale(0.75, 0.75, 0.75):rotate('y', 30):translate(0, 0.75, 0)
        end},
    },
    {
        {'square', function(m) return gr.square(m):scale(1.5, 1, 1.5):rotate('x', 75):rotate('y', -15):translate(0, 0.8, 0) end},
        {'rectangle', function(m) return gr.rectangle {corner = {-0.95, 0.1, 0}, along = {1.4, 0, 0.2}, up = {0.5, 1.3, -0.2}, material = m} end},
        {'disc', function(m) return gr.disc {centre = {0, 0.8, 0}, radius = 0.8, normal = {-0.3, 0.2, 1}, material = m} end},
        {'ring', function(m) return gr.disc {centre = {0, 0.8, 0}, radius = 0.8, inner = 0.45, normal = {0.3, 0.25, 1}, material = m} end},
        {'triangle', function(m) return gr.triangle {a = {-0.85, 0.05, 0}, b = {0.85, 0.05, 0.2}, c = {0.1, 1.55, -0.2}, material = m} end},
        {'polygon', function(m)
            local points = {}
            for k, p in ipairs(ring_of(6, 0.85)) do points[k] = {p[1], p[2], 0} end
            return gr.polygon {points = points, material = m}:rotate('y', 15):translate(0, 0.85, 0)
        end},
        {'with a hole', function(m) return gr.polygon {points = star_points, outlines = star_outlines, material = m}:rotate('y', -15):translate(0, 0.9, 0) end},
        {'pinched', function(m)
            return gr.superellipsoid {e = 2.8, n = 2.8, material = m}:scale(1.05, 0.95, 1.05):rotate('y', 20):translate(0, 0.95, 0)
        end},
    },
    {
        {'lathe', function(m)
            return gr.lathe {points = {{0, 0}, {0.7, 0}, {0.7, 0.12}, {0.3, 0.3}, {0.3, 0.9}, {0.55, 1.1}, {0.3, 1.3}, {0.3, 1.5}, {0, 1.6}}, material = m}
        end},
        {'spline lathe', function(m)
            return gr.lathe {points = {{0, 0}, {0.5, 0}, {0.85, 0.6}, {0.45, 1.15}, {0.35, 1.4}, {0.6, 1.62}, {0.5, 1.62}, {0.25, 1.38}, {0.25, 1.3}, {0, 1.25}},
                spline = 'catmull-rom', material = m}
        end},
        {'prism', function(m)
            return gr.prism {outline = star(6, 0.95, 0.6), holes = {ring_of(24, 0.32)}, to = 0.6, material = m}:rotate('x', 68):rotate('y', 15):translate(0, 0.8, 0)
        end},
        {'spline prism', function(m)
            local outline = {}
            for k = 0, 9 do
                local r = k % 2 == 0 and 0.95 or 0.45
                outline[k + 1] = {r * cos(k * pi / 5), r * sin(k * pi / 5)}
            end
            return gr.prism {outline = outline, spline = 'catmull-rom', to = 0.55, material = m}:rotate('x', 68):rotate('y', -15):translate(0, 0.85, 0)
        end},
        {'sweep', function(m)
            local points, radii = {}, {}
            for k = 0, 24 do
                points[k + 1] = {0.55 * cos(k * 0.8), 0.2 + 1.25 * k / 24, 0.55 * sin(k * 0.8)}
                radii[k + 1] = 0.2 - 0.17 * k / 24
            end
            return gr.sweep {points = points, radii = radii, material = m}
        end},
        {'curve', hair},
        {'blob', function(m)
            return gr.blob {threshold = 0.5, spheres = {{-0.35, 0.5, 0, 0.75, 1.2}, {0.42, 0.6, 0.1, 0.7, 1.2}, {0.05, 1.15, 0, 0.6, 1.2}, {0.1, 0.75, 0.55, 0.35, -0.8}},
                material = m}
        end},
        {'blob of rods', function(m)
            local rods = {}
            for k = 0, 4 do
                local a = 2 * pi * k / 5 + 0.3
                rods[k + 1] = {0, 0.35, 0, 0.75 * cos(a), 0.85 + 0.35 * sin(2 * a), 0.75 * sin(a), 0.38, 1}
            end
            return gr.blob {threshold = 0.4, spheres = {{0, 0.4, 0, 0.55, 1}}, cylinders = rods, material = m}
        end},
    },
    {
        {'height field', function(m)
            return gr.height_field {heights = hills, floor = -0.12, smooth = true, material = m}
                :translate(-0.5, 0.12, -0.5):scale(1.9, 1.7, 1.9):rotate('y', 30)
        end},
        {'from a picture', function(m)
            return gr.height_field {image = '../textures/earth.png', floor = -0.4, smooth = true, material = m}
                :translate(-0.5, 0.4, -0.5):scale(2, 0.35, 1.4):rotate('x', 32):rotate('y', -12):translate(0, 0.42, 0)
        end},
        {'patch', function(m) return gr.patch {points = patch, tolerance = 0.001, material = m}:rotate('y', 35) end},
        {'mesh', function(m) return gr.mesh(m, polyhedra.dodecahedron()):scale(0.85, 0.85, 0.85):rotate('y', 10):translate(0, 0.7, 0) end},
        {'smooth mesh', function(m)
            return gr.vn_mesh(m, knot.mesh(2, 3, {radius = 0.2, around = 20})):scale(0.6, 0.6, 0.6):rotate('x', 80):translate(0, 0.85, 0)
        end},
        {'union', function(m)
            return gr.union('union', gr.nh_box(m, {-0.5, 0, -0.5}, 1), gr.sphere {centre = {0, 1, 0}, radius = 0.62, material = m}):rotate('y', 25)
        end},
        {'intersection', function(m)
            return gr.intersection('intersection', gr.nh_box(m, {-0.68, 0, -0.68}, 1.36),
                gr.sphere {centre = {0, 0.68, 0}, radius = 0.88, material = knife}):rotate('y', 25)
        end},
        {'difference', function(m)
            return gr.difference('difference', gr.nh_box(m, {-0.65, 0, -0.65}, 1.3), gr.sphere {centre = {0, 0.65, 0}, radius = 0.82, material = knife})
                :rotate('y', 25)
        end},
    },
}

local scene = gr.node('solids')
scene:add_child(gr.plane {normal = {0, 1, 0}, material = ground})
local words = {}
for r, row in ipairs(show) do
    local y, z = 2.05 * r - 1.3, -2.5 * r
    scene:add_child(gr.box {name = 'step', min = {-10.2, 0, z - 1.25}, max = {10.2, y, z + 1.25}, material = ivory})
    for k, entry in ipairs(row) do
        local c = colour.palette('toy', ((k - 1) * 3 + r) % 8 / 7)
        -- surfaces without an inside are lit from both sides
        local flat = r == 3 and k < 8 or entry[1] == 'open tube' or entry[1] == 'paraboloid' or entry[1] == 'patch' or entry[1] == 'curve'
        local m = flat and gr.material {kd = c, ks = {0.3, 0.3, 0.3}, shininess = 60, two_sided = true} or
            gr.rr_material(c, {0.4, 0.4, 0.4}, 80, 0.10, 0, 1.5)
        local place = gr.node(entry[1])
        place:add_child(entry[2](m))
        place:translate(2.5 * k - 11.25, y, z - 0.15)
        scene:add_child(place)
        -- its name on the riser; every name is rendered once
        words[entry[1]] = words[entry[1]] or gr.vn_mesh(ink, text.mesh(entry[1], {size = 0.38, depth = 0.01, align = 'centre', tolerance = 0.004}))
        scene:add_child(gr.node {name = 'word', children = {words[entry[1]]}}:translate(2.5 * k - 11.25, y - 0.38, z + 1.25))
    end
end

gr.render {
    node = scene, file = 'solids.png', width = 1200, height = 800, eye = {0, 13.0, 17.5}, target = {0, 4.55, -6}, fov = 34,
    ambient = {0.30, 0.31, 0.34}, background = {0.62, 0.70, 0.80},
    lights = {
        gr.area_light({-13, 19, 4}, {5, 0, 0}, {0, 1.6, 5}, {0.74, 0.71, 0.64}, {1, 0, 0}),
        gr.light({4, 18, 17}, {0.20, 0.22, 0.27}, {1, 0, 0}),
    },
}
