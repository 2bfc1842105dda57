-- TITLE: Functions: a gyroid lamp cut by CSG
-- A shade of two gyroids in a ball, an implicit solid, with a bite and a foot cut by CSG; the floor is a pattern in Lua.
-- Author: gray project

local patterns, sdf = require 'patterns', require 'sdf'

local shade = gr.implicit {
    f = sdf.intersection(sdf.shell(sdf.sphere(1), 0.12), sdf.gyroid(0.55, 0.1)), radius = 1.1,
}
local brass = gr.rr_material({ 0.50, 0.32, 0.10 }, { 0.8, 0.6, 0.3 }, 60, 0.15, 0, 1)
local cut = gr.difference('shade', shade, gr.box { min = { -0.5, 0.72, -1.2 }, max = { 1.2, 1.2, 1.2 } },
    gr.cylinder { from = { 0, -1.3, 0 }, to = { 0, -0.7, 0 }, radius = 0.42 }, gr.sphere { centre = { 0.95, 0.1, 0.95 }, radius = 0.55 })
cut:set_material(gr.material { kd = { 0.80, 0.70, 0.52 }, ks = { 0.3, 0.3, 0.3 }, shininess = 40, two_sided = true })

local lamp = gr.node 'lamp'
lamp:add_child(cut)
lamp:add_child(gr.sphere { radius = 0.28, material = gr.material { kd = { 0, 0, 0 }, emission = { 1, 0.86, 0.6 }, lit = false } })
lamp:add_child(gr.implicit {
    f = sdf.smooth_union(0.15, sdf.capsule({ 0, -1.65, 0 }, { 0, -0.6, 0 }, 0.07), sdf.translate(sdf.cylinder(0.5, 0.04), { 0, -1.7, 0 })),
    bounds = { { -0.6, -1.75, -0.6 }, { 0.6, -0.4, 0.6 } }, material = brass,
})

local function boards(p)
    local inside, id = patterns.bricks({ p.x, 0.17, p.z }, { size = { 2.4, 1, 0.35 }, joint = 0.012 })
    local grain = patterns.map('pine', patterns.wood(gr.vec(p.z * 0.7 + id * 7, id * 3 + 0.3, p.x)))
    return gr.mix(0.05, grain * (0.45 + 0.3 * id), inside)
end
local scene = gr.node 'scene'
scene:add_child(lamp:translate(0, 1.75, 0))
scene:add_child(gr.plane { normal = { 0, 1, 0 }, material = gr.material { kd = boards, ks = { 0.15, 0.15, 0.15 }, shininess = 30 } })
scene:add_child(gr.plane { normal = { 0, 0, 1 }, distance = -2.5, material = gr.material { kd = { 0.46, 0.42, 0.40 } } })

gr.render {
    node = scene, file = 'lamp.png', width = 400, height = 400, eye = { 2.2, 2.9, 6.4 }, target = { 0, 1.35, 0 }, fov = 32,
    ambient = { 0.16, 0.16, 0.19 }, background = { 0.02, 0.02, 0.03 },
    lights = { gr.light({ 0, 2.15, 0.1 }, { 1.0, 0.84, 0.58 }, { 1, 0, 0.02 }), gr.light({ 5, 6, 7 }, { 0.60, 0.62, 0.68 }, { 1, 0, 0 }) },
}
