-- TITLE: Library: palettes, temperatures and easing
-- Rows of pegs in the colours of the palettes, lamps of 1,500 to 15,000 kelvin, and balls at positions given by easing
-- functions. put them.
-- Author: gray project

local studio = require 'studio'
local colour, easing = require 'colour', require 'easing'

local scene = gr.node 'colours'
local names = { 'viridis', 'magma', 'sea', 'land', 'earth', 'sunset', 'pastel', 'toy' }
for row, name in ipairs(names) do
    for k = 0, 23 do
        local t = k / 23
        local x, z = -6.2 + 0.3 * k, 2.4 - 0.62 * row
        local material = studio.matt(colour.palette(name, t))
        local top = 0.22 + 0.1 * row
        scene:add_child(gr.cylinder { from = { x, 0, z }, to = { x, top, z }, radius = 0.13, material = material })
        scene:add_child(gr.sphere { centre = { x, top, z }, radius = 0.13, material = material })
    end
end

-- Glowing balls on a board.
for k = 0, 8 do
    local kelvin = 1500 * 10 ^ (k / 8)
    local c = colour.blackbody(kelvin)
    scene:add_child(gr.sphere { centre = { -6.0 + 0.84 * k, 2.5, -4.6 }, radius = 0.34,
        material = gr.material { kd = { 0, 0, 0 }, emission = c, lit = false } })
    scene:add_child(gr.cylinder { from = { -6.0 + 0.84 * k, 0, -4.6 }, to = { -6.0 + 0.84 * k, 2.2, -4.6 }, radius = 0.05, material = studio.silver })
end

-- Easing: time to the right, the value upwards.
local functions = { { 'in_out_cubic', 0.03 }, { 'out_bounce', 0.13 }, { 'out_elastic', 0.56 }, { 'in_out_back', 0.75 } }
for row, item in ipairs(functions) do
    local material, z = studio.glaze(colour.hsv(360 * item[2], 0.7, 0.8)), 2.2 - 1.45 * row
    for k = 0, 40 do
        local t = k / 40
        scene:add_child(gr.sphere { centre = { 1.9 + 4.3 * t, 0.25 + 1.55 * easing[item[1]](t), z }, radius = 0.1, material = material })
    end
    scene:add_child(gr.box { min = { 1.7, 0, z - 0.12 }, max = { 6.4, 0.04, z + 0.12 }, material = studio.matt { 0.3, 0.3, 0.34 } })
end

studio.render {
    node = scene, file = 'show_colours.png', eye = { 0, 7.4, 15 }, target = { 0.1, 0.85, -0.9 }, fov = 26, floor = { 0.30, 0.30, 0.31 },
}
