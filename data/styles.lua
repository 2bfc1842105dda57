-- TITLE: Drawn pictures: none, ink, toon and Gooch
-- The same still life four times; docs/finishing.md has the formulas. docs/styles.png is its contact sheet:
--   ./gray data/styles.lua -o styles.apng --contact-sheet
-- Author: gray project

local gear = require 'gear'

local function glaze(r, g, b) return gr.material({ r, g, b }, { 0.5, 0.5, 0.5 }, 60) end

local scene = gr.node 'still life'
scene:add_child(gr.cylinder { from = { 0, -0.3, 0 }, to = { 0, 0, 0 }, radius = 4.2, material = glaze(0.62, 0.45, 0.30) })

local vase = gr.lathe {
    spline = 'catmull-rom', material = glaze(0.20, 0.42, 0.70),
    points = { { 0, 0 }, { 0.7, 0 }, { 0.8, 0.1 }, { 1.15, 0.95 }, { 1.0, 1.7 }, { 0.45, 2.3 }, { 0.42, 2.6 }, { 0.7, 2.95 }, { 0.6, 2.95 },
        { 0.33, 2.6 }, { 0, 2.4 } },
}
scene:add_child(vase:translate(-1.5, 0, -0.6))

local knot = {}
for k = 0, 35 do
    local t = 2 * math.pi * k / 36
    knot[k + 1] = { math.sin(t) + 2 * math.sin(2 * t), -math.sin(3 * t), math.cos(t) - 2 * math.cos(2 * t) }
end
scene:add_child(gr.sweep { points = knot, radii = 0.5, loop = true, material = glaze(0.85, 0.64, 0.18) }
    :rotate('x', 90):scale(0.4, 0.4, 0.4):rotate('y', 24):translate(1.2, 1.3, -1.1))

local wheel = gear.new { teeth = 18, module = 0.1 }
scene:add_child(gr.vn_mesh(glaze(0.35, 0.62, 0.36), gear.mesh(wheel, { width = 0.45, bore = 0.3 })):rotate('x', -90):translate(1.7, 0.23, 1.5))

local die = gr.difference('die', gr.intersection('rounded', gr.box { min = { -1, -1, -1 }, max = { 1, 1, 1 } }, gr.sphere { radius = 1.42 }),
    gr.sphere { centre = { 0, 0, 1.1 }, radius = 0.4 }, gr.sphere { centre = { 0, 1.1, 0 }, radius = 0.4 }, gr.sphere { centre = { 1.1, 0, 0 }, radius = 0.4 })
die:set_material(glaze(0.80, 0.25, 0.20))
scene:add_child(die:scale(0.62, 0.62, 0.62):rotate('y', 32):translate(-0.7, 0.62, 1.7))

for number, style in ipairs { 'none', 'ink', 'toon', 'gooch' } do
    gr.render {
        node = scene, file = 'styles' .. number .. '.png', width = 320, height = 240, style = style,
        eye = { 0.6, 4.6, 10.5 }, target = { -0.05, 0.75, 0 }, fov = 36, ambient = { 0.22, 0.23, 0.26 }, background = { 0.90, 0.92, 0.94 },
        lights = { gr.light({ -7, 10, 8 }, { 0.78, 0.76, 0.70 }, { 1, 0, 0 }) },
    }
end
