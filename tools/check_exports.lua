-- Solids for tools/check_exports.sh: one of every kind, in millimetres.
local red = gr.material { kd = { 0.8, 0.2, 0.1 } }
local blue = gr.material { kd = { 0.1, 0.2, 0.8 } }
local spots = gr.material { kd = function(p) return { math.sin(p[1]) > 0 and 1 or 0, math.sin(p[2]) > 0 and 1 or 0, 0.5 } end }
local box = function(x, y, z, material) return gr.box { min = { 0, 0, 0 }, max = { x, y, z }, material = material or red } end

local plate = box(60, 40, 4)
for i = 0, 29 do
    plate = gr.difference(plate, gr.cylinder { from = { 5 + 10 * (i % 6), 4 + 8 * (i // 6), -1 }, to = { 5 + 10 * (i % 6), 4 + 8 * (i // 6), 5 }, radius = 2 + i / 20, material = blue })
end

local solids = {
    cube = box(20, 20, 20),
    ball = gr.sphere { centre = { 0, 0, 10 }, radius = 10, material = spots },
    ring = gr.torus { major = 12, minor = 4, material = red },
    cone = gr.cone { from = { 0, 0, 20 }, to = { 0, 0, 0 }, radius = 8, material = red },
    plate_of_30_holes = plate,
    dice = gr.difference(gr.intersection(box(20, 20, 20), gr.sphere { centre = { 10, 10, 10 }, radius = 13.5, material = blue }),
        gr.sphere { centre = { 10, 10, 20 }, radius = 3, material = blue }, gr.sphere { centre = { 0, 10, 10 }, radius = 3, material = spots }),
    shell = gr.difference(gr.sphere { centre = { 0, 0, 10 }, radius = 10, material = red }, gr.sphere { centre = { 0, 0, 10 }, radius = 8, material = blue },
        gr.cylinder { from = { 0, 0, 10 }, to = { 0, 0, 30 }, radius = 3, material = blue }),
    tube = gr.difference(gr.cylinder { from = { 0, 0, 0 }, to = { 0, 0, 30 }, radius = 6, material = red }, gr.cylinder { from = { 0, 0, -1 }, to = { 0, 0, 31 }, radius = 5, material = red }),
    gyroid = gr.intersection(gr.implicit {
        material = red, bounds = { { -11, -11, -11 }, { 11, 11, 11 } },
        f = function(p) local q = p * 0.4 return math.abs(math.sin(q.x) * math.cos(q.y) + math.sin(q.y) * math.cos(q.z) + math.sin(q.z) * math.cos(q.x)) - 0.5 end,
    }, gr.sphere { radius = 10, material = blue }),
    letters = require('text').node('gray', { size = 20, depth = 4, material = blue }),
    two_that_touch = gr.union(box(10, 10, 10), box(10, 10, 10, blue):translate(10, 10, 0)),
    two_objects = gr.node { name = 'two objects', children = { gr.node { name = 'left', children = { box(10, 10, 10) } }, gr.sphere { name = 'right', centre = { 30, 0, 5 }, radius = 5, material = spots } } },
}

local names = {}
for name in pairs(solids) do names[#names + 1] = name end
table.sort(names)
for _, name in ipairs(names) do
    for _, ending in ipairs { 'stl', '3mf', 'obj', 'ply' } do solids[name]:export(name .. '.' .. ending, { tolerance = 0.05 }) end
end
