-- TITLE: To print: a phone stand
-- Millimetres, z up. Writes phone_stand.stl and phone_stand.3mf beside its picture (docs/export.md).
-- Author: gray project

local plastic = gr.material({ 0.85, 0.35, 0.12 }, { 0.3, 0.3, 0.3 }, 60)

-- The outline of the side, extruded along y: a foot, a back that leans by 20 degrees, and a lip.
local outline = {
    { 0, 0 }, { 80, 0 }, { 80, 6 }, { 76, 14 }, { 71, 12.5 }, { 73, 7 }, { 38, 7 }, { 12, 78 }, { 5, 76 }, { 30, 7 }, { 6, 7 }, { 0, 4 },
}
local side = gr.prism { name = 'side', material = plastic, outline = outline, from = 0, to = 60 }

local part = gr.difference {
    side,
    gr.cylinder { name = 'cable', from = { 50, 30, -1 }, to = { 50, 30, 9 }, radius = 8 },
    gr.box { name = 'slot', min = { 50, 22, -1 }, max = { 90, 38, 20 } },
    gr.cylinder { name = 'window', from = { -5, 30, 42 }, to = { 60, 30, 42 }, radius = 16 },
    name = 'phone stand',
}
part:set_material(plastic)

part:export('phone_stand.stl', { tolerance = 0.03 })
part:export('phone_stand.3mf', { tolerance = 0.03 })

gr.render {
    node = part, file = 'phone_stand.png', eye = { 190, -130, 130 }, target = { 40, 30, 30 }, fov = 32, width = 480, height = 360, up = { 0, 0, 1 }, ambient = { 0.3, 0.3, 0.32 },
    lights = { gr.light { position = { 300, -400, 500 }, colour = { 0.7, 0.7, 0.7 } }, gr.light { position = { -400, -300, 200 }, colour = { 0.25, 0.25, 0.3 } } },
}
