-- TITLE: To print: a gear box
-- Two wheels on the axles of a case; three parts in one file. Millimetres, z up.
-- Author: gray project

local gear = require 'gear'

local case_material = gr.material({ 0.25, 0.35, 0.5 }, { 0.3, 0.3, 0.3 }, 60)
local wheel_material = gr.material({ 0.85, 0.7, 0.2 }, { 0.4, 0.4, 0.4 }, 80)

local big = gear.new { teeth = 24, module = 2, backlash = 0.3 }
local small = gear.new { teeth = 12, module = 2, shift = 0.3, backlash = 0.3 }
local distance, angle = gear.mate(big, small, 0)

-- An outline lies in x and z; turned upright its thickness is along z, and z of the outline is -y.
local function wheel(name, which, turn, x)
    local prism = gr.prism { name = name, material = wheel_material, outline = gear.outline(which), holes = { gear.circle(4.2) }, from = 0, to = 8 }
    prism:rotate('y', turn):rotate('x', 90):translate(x, 0, 4)
    return prism
end

local height, wall = 18, 2.4
local function capsule(radius, low, high)
    return gr.union {
        gr.cylinder { from = { 0, 0, low }, to = { 0, 0, high }, radius = radius },
        gr.cylinder { from = { distance, 0, low }, to = { distance, 0, high }, radius = radius },
        gr.box { min = { 0, -radius, low }, max = { distance, radius, high } },
    }
end
local function axle(x) return gr.cylinder { from = { x, 0, 0 }, to = { x, 0, 14 }, radius = 3.9 } end
local case = gr.union {
    gr.difference { capsule(big.tip + 2 + wall, 0, height), capsule(big.tip + 2, wall, height + 1) },
    axle(0), axle(distance),
    gr.cylinder { from = { 0, 0, 1 }, to = { 0, 0, 3.6 }, radius = 7 }, gr.cylinder { from = { distance, 0, 1 }, to = { distance, 0, 3.6 }, radius = 7 },
    name = 'case',
}
case:set_material(case_material)
local wheel_a, wheel_b = wheel('big wheel', big, 0, 0), wheel('small wheel', small, angle, distance)

-- For the printer the wheels lie beside the case.
local plate = gr.node 'plate'
plate:add_child(case)
for i, part in ipairs { wheel_a, wheel_b } do
    local beside = gr.node('beside')
    beside:add_child(part)
    beside:translate(i == 1 and 0 or -distance + 45, -75, -4)
    plate:add_child(beside)
end
plate:export('gear_box.stl', { tolerance = 0.04 })
plate:export('gear_box.3mf', { tolerance = 0.04 })

gr.render {
    node = gr.node { name = 'closed', children = { case, wheel_a, wheel_b } }, file = 'gear_box.png', eye = { 60, -120, 110 }, target = { 18, -0, 0 }, fov = 36, width = 480, height = 360, up = { 0, 0, 1 }, ambient = { 0.3, 0.3, 0.32 },
    lights = { gr.light { position = { 300, -400, 500 }, colour = { 0.7, 0.7, 0.7 } }, gr.light { position = { -400, -300, 200 }, colour = { 0.25, 0.25, 0.3 } } },
}
