-- TITLE: Fresnel
-- Dielectrics whose reflectance depends on the angle: balls of rising index over dark water, a block of glass, a
-- bubble. Author: gray project

local stage = require 'stage'
local polyhedra = require 'polyhedra'

local root = gr.node('root')

-- water: transparent at steep angles, a mirror at grazing angles
local water = gr.difresnel_material(gr.rr_material({ 0, .004, .006 }, { .93, .97, .97 }, 300, 0, 1, 1.33))
root:add_child(stage.box('water', water, { -30, -1.5, -60 }, { 30, 0, 12 }))
local bed = stage.checkers('bed', gr.material({ .34, .42, .36 }, { 0, 0, 0 }, 1), gr.material({ .62, .64, .52 }, { 0, 0, 0 }, 1),
    -30, -60, 30, 12, 1)
bed:translate(0, -1.4, 0)
root:add_child(bed)

local indices = { 1.1, 1.33, 1.5, 1.8, 2.42 }
for k, ior in ipairs(indices) do
    local glass = gr.difresnel_material(gr.rr_material({ 0, 0, 0 }, { .98, .98, .98 }, 300, 0, 1, ior))
    root:add_child(stage.ball('ball ' .. ior, glass, { (k - 3) * 1.32, .66, 0 }, .56))
end

local green = gr.difresnel_material(gr.rr_material({ 0, .01, 0 }, { .80, .97, .88 }, 300, 0, 1, 1.5))
local gem = gr.geometry('gem', gr.mesh(green, polyhedra.icosahedron()))
gem:rotate('y', 15)
gem:scale(.75, .75, .75)
gem:translate(-2.3, .95, -2.6)
root:add_child(gem)
local block = stage.box('block', green, { -.55, 0, -.55 }, { .55, 1.5, .55 })
block:rotate('y', 35)
block:translate(2.2, .08, -2.6)
root:add_child(block)
-- almost the index of air: visible only at the rim
root:add_child(stage.ball('soap bubble', gr.difresnel_material(gr.rr_material({ 0, 0, 0 }, { 1, .97, 1 }, 300, 0, 1, 1.03)), { .1, 1.35, -3 }, 1.1))
root:add_child(stage.ball('red', gr.material({ .75, .14, .10 }, { .4, .4, .4 }, 50), { -.9, .32, -1.7 }, .3))
root:add_child(stage.ball('blue', gr.material({ .12, .25, .60 }, { .4, .4, .4 }, 50), { .85, .32, -1.5 }, .3))

gr.render_skybox(root, '13demo.png', '../textures/sky_evening.png', 640, 480, { 0, 1.55, 6.4 }, { 0, -.155, -1 },
    { 0, 1, 0 }, 47, { .45, .45, .45 }, {
        gr.light({ -6, 9, 8 }, { .65, .62, .58 }, { 1, 0, 0 }),
    })
