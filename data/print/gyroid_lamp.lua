-- TITLE: To print: a lamp of gyroids
-- The wall of a ball is a gyroid; a ring holds a bulb. Millimetres, z up.
-- Author: gray project

local white = gr.material({ 0.9, 0.88, 0.82 }, { 0.1, 0.1, 0.1 }, 20)
local scale = 2 * math.pi / 32

local function gyroid(p)
    local q = p * scale
    return math.abs(math.sin(q.x) * math.cos(q.y) + math.sin(q.y) * math.cos(q.z) + math.sin(q.z) * math.cos(q.x)) - 0.45
end

local shade = gr.intersection {
    gr.implicit { material = white, f = gyroid, bounds = { { -51, -51, -51 }, { 51, 51, 51 } } },
    gr.difference { gr.sphere { radius = 50, material = white }, gr.sphere { radius = 44, material = white } },
    name = 'shade',
}
local lamp = gr.difference {
    gr.union { shade, gr.cylinder { from = { 0, 0, -50 }, to = { 0, 0, -38 }, radius = 30, material = white } },
    gr.cylinder { from = { 0, 0, -51 }, to = { 0, 0, -37 }, radius = 20, material = white },
    gr.box { min = { -60, -60, -60 }, max = { 60, 60, -48 }, material = white },
    name = 'lamp',
}
lamp:export('gyroid_lamp.stl', { tolerance = 0.4 })
lamp:export('gyroid_lamp.3mf', { tolerance = 0.4 })

gr.render {
    node = lamp, file = 'gyroid_lamp.png', eye = { 150, -190, 90 }, target = { 0, -0, 0 }, fov = 36, width = 400, height = 400, up = { 0, 0, 1 }, ambient = { 0.3, 0.3, 0.32 },
    lights = { gr.light { position = { 300, -400, 500 }, colour = { 0.7, 0.7, 0.7 } }, gr.light { position = { -400, -300, 200 }, colour = { 0.25, 0.25, 0.3 } } },
}
