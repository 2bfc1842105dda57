-- TITLE: A machine part: threads, fillets, countersinks, cut open
-- OPTIONS: -reflect-limit 1 -al-samples 3
-- One solid of some fifty operands, with a quarter cut out to show its bore and its thread, a bolt and a nut.

local steel = gr.rr_material({0.42, 0.44, 0.47}, {0.55, 0.56, 0.58}, 60, 0.22, 0, 1)
local section = gr.material({0.72, 0.20, 0.12}, {0.1, 0.1, 0.1}, 20)
local brass = gr.rr_material({0.62, 0.46, 0.18}, {0.6, 0.5, 0.3}, 70, 0.2, 0, 1)
local black = gr.rr_material({0.08, 0.08, 0.09}, {0.4, 0.4, 0.4}, 40, 0.10, 0, 1)
local paper = gr.material({0.62, 0.64, 0.62}, {0, 0, 0}, 1)
local line = gr.material({0.42, 0.50, 0.56}, {0, 0, 0}, 1)

local function rod(r, low, high, m) return gr.cylinder {from = {0, low, 0}, to = {0, high, 0}, radius = r, material = m} end

-- A groove along a helix, to be cut from a rod or to be added in a bore.
local function helix(r, low, high, pitch, depth)
    local points, steps = {}, 10
    for k = 0, math.floor((high - low) / pitch * steps) do
        local a = 2 * math.pi * k / steps
        points[k + 1] = {r * math.cos(a), low + pitch * k / steps, r * math.sin(a)}
    end
    return gr.sweep {points = points, radii = depth, spline = 'catmull-rom'}
end

-- The fillet between a post and its plate: a ring minus a torus.
local function fillet(r, y, size)
    return gr.difference('fillet', rod(r + size, y, y + size),
        gr.torus {major = r + size, minor = size}:translate(0, y + size, 0))
end

-- A plate with round corners and edges: boxes, rods and balls.
local function plate(x, z, height, corner, edge)
    local parts = {
        gr.box {min = {-x, edge, -z + corner}, max = {x, height - edge, z - corner}},
        gr.box {min = {-x + corner, edge, -z}, max = {x - corner, height - edge, z}},
        gr.box {min = {-x + corner, 0, -z + corner}, max = {x - corner, height, z - corner}},
        gr.box {min = {-x + edge, 0, -z + corner}, max = {x - edge, height, z - corner}},
        gr.box {min = {-x + corner, 0, -z + edge}, max = {x - corner, height, z - edge}},
    }
    for i = -1, 1, 2 do
        for j = -1, 1, 2 do
            local cx, cz = i * (x - corner), j * (z - corner)
            parts[#parts + 1] = rod(corner, edge, height - edge):translate(cx, 0, cz)
            parts[#parts + 1] = rod(corner - edge, 0, height):translate(cx, 0, cz)
            parts[#parts + 1] = gr.torus {major = corner - edge, minor = edge}:translate(cx, height - edge, cz)
        end
        parts[#parts + 1] = gr.cylinder {from = {i * (x - edge), height - edge, -z + corner}, to = {i * (x - edge), height - edge, z - corner}, radius = edge}
        parts[#parts + 1] = gr.cylinder {from = {-x + corner, height - edge, i * (z - edge)}, to = {x - corner, height - edge, i * (z - edge)}, radius = edge}
    end
    return gr.union('plate', table.unpack(parts))
end

-- --- the part ---

local adds = {plate(2.0, 1.4, 0.45, 0.45, 0.08), rod(0.85, 0.3, 1.75), fillet(0.85, 0.45, 0.22),
    gr.torus {major = 0.77, minor = 0.08}:translate(0, 1.75, 0), rod(0.77, 1.7, 1.83)}
for k = 0, 1 do -- webs
    adds[#adds + 1] = gr.prism {outline = {{0.7, 0.4}, {1.75, 0.4}, {0.7, 1.35}}, from = -0.09, to = 0.09}:rotate('x', -90):rotate('y', 180 * k)
end
local takes = {rod(0.40, -1, 3), rod(0.52, 1.3, 3), helix(0.40, 0.02, 1.3, 0.13, 0.055), gr.cone {from = {0, 1.72, 0}, from_radius = 0.5, to = {0, 1.9, 0}, radius = 0.68}}
for i = -1, 1, 2 do
    for j = -1, 1, 2 do
        takes[#takes + 1] = rod(0.16, -1, 1):translate(1.55 * i, 0, 0.95 * j)
        takes[#takes + 1] = gr.cone {from = {1.55 * i, 0.28, 0.95 * j}, from_radius = 0.16, to = {1.55 * i, 0.47, 0.95 * j}, radius = 0.32}
    end
end
local part = gr.difference('part', gr.union('adds', table.unpack(adds)), table.unpack(takes)):set_material(steel)
local quarter = gr.box {min = {0, -1, 0}, max = {5, 5, 5}, material = section}
local open_part = gr.difference('cut open', part, quarter)

-- --- bolt and nut ---

local function hexagon(r, low, high)
    local sides = {rod(r * 1.2, low, high)}
    for k = 0, 5 do
        local a = k * math.pi / 3
        sides[#sides + 1] = gr.plane {normal = {math.cos(a), 0, math.sin(a)}, distance = r}
    end
    sides[#sides + 1] = gr.cone {from = {0, low - 0.4, 0}, from_radius = r * 1.9, to = {0, high + 0.05, 0}, radius = r * 1.02}
    return gr.intersection('hexagon', table.unpack(sides))
end
local bolt = gr.difference('bolt', gr.union('blank', rod(0.38, 0, 2.1), hexagon(0.58, 2.05, 2.45), fillet(0.38, 0, 0.01)),
    helix(0.39, -0.05, 1.45, 0.13, 0.055), gr.difference('tip', rod(0.6, -0.1, 0.14), gr.cone {from = {0, -0.1, 0}, from_radius = 0.22, to = {0, 0.15, 0}, radius = 0.42})):set_material(brass)
local nut = gr.difference('nut', hexagon(0.62, 0, 0.42), rod(0.36, -1, 1), helix(0.37, -0.1, 0.6, 0.13, 0.055)):set_material(black)

local scene = gr.node('workbench')
scene:add_child(open_part)
scene:add_child(bolt:rotate('z', 90):rotate('y', 12):translate(0.95, 0.5, 3.0))
scene:add_child(nut:rotate('y', 20):translate(2.7, 0, 1.7))
scene:add_child(gr.box {min = {-40, -0.5, -40}, max = {40, 0, 40}, material = paper})
for k = -8, 8 do
    scene:add_child(gr.box {min = {1.5 * k - 0.015, -0.1, -14}, max = {1.5 * k + 0.015, 0.002, 14}, material = line})
    scene:add_child(gr.box {min = {-14, -0.1, 1.5 * k - 0.015}, max = {14, 0.002, 1.5 * k + 0.015}, material = line})
end
gr.render {
    node = scene, file = 'machine.png', width = 420, height = 280, eye = {3.4, 4.6, 7.2}, target = {0.1, 0.5, 0.75}, fov = 35,
    ambient = {0.34, 0.34, 0.36}, background = {0.70, 0.74, 0.78},
    lights = {gr.area_light({-5, 8, 3}, {2, 0, 0}, {0, 0, 2}, {0.72, 0.70, 0.66}, {1, 0, 0}), gr.light({8, 7, 4}, {0.26, 0.27, 0.30}, {1, 0, 0})},
}
