-- TITLE: Functions: a gyroid lamp cut by CSG
-- OPTIONS: --spp 4
-- A shade of two gyroids in a ball, an implicit solid, with a bite and a foot cut by CSG; the floor is a pattern in Lua.
-- The only light is the bulb in it, so the shade draws itself on the wall.
-- Author: gray project

local patterns, sdf = require 'patterns', require 'sdf'

local shade = gr.implicit {
    f = sdf.intersection(sdf.shell(sdf.sphere(1), 0.12), sdf.gyroid(0.55, 0.1)), radius = 1.1,
}
local brass = gr.metal_material { metal = 'brass', roughness = function(p) return 0.16 + 0.12 * gr.turbulence(p * 5, 3) end }
local cut = gr.difference('shade', shade, gr.box { min = { -0.5, 0.72, -1.2 }, max = { 1.2, 1.2, 1.2 } },
    gr.cylinder { from = { 0, -1.3, 0 }, to = { 0, -0.7, 0 }, radius = 0.42 }, gr.sphere { centre = { 0.95, 0.1, 0.95 }, radius = 0.55 })
cut:set_material(gr.openpbr_material { base_color = { 0.80, 0.72, 0.60 }, specular_roughness = 0.4, specular_weight = 0.6 })

local lamp = gr.node 'lamp'
lamp:add_child(cut)
lamp:add_child(gr.implicit {
    f = sdf.smooth_union(0.15, sdf.capsule({ 0, -1.65, 0 }, { 0, -0.6, 0 }, 0.07), sdf.translate(sdf.cylinder(0.5, 0.04), { 0, -1.7, 0 })),
    bounds = { { -0.6, -1.75, -0.6 }, { 0.6, -0.4, 0.6 } }, material = brass,
})

local function boards(p)
    local inside, id = patterns.bricks({ p.x, 0.17, p.z }, { size = { 2.4, 1, 0.35 }, joint = 0.012 })
    local grain = patterns.map('pine', patterns.wood(gr.vec(p.z * 0.7 + id * 7, id * 3 + 0.3, p.x)))
    return gr.mix(0.01, grain * (0.16 + 0.16 * id), inside)
end
local scene = gr.node 'scene'
scene:add_child(lamp:translate(0, 1.75, 0))
scene:add_child(gr.plane { normal = { 0, 1, 0 }, material = gr.openpbr_material { base_color = boards, specular_roughness = 0.35, coat_weight = 0.4, coat_roughness = 0.2 } })
local function plaster(p) return gr.vec(0.62, 0.53, 0.44) * (1 - 0.12 * gr.turbulence(p * 0.9, 3)) end
scene:add_child(gr.plane { normal = { 0, 0, 1 }, distance = -2.3, material = gr.openpbr_material { base_color = plaster, specular_weight = 0.3, specular_roughness = 0.6 } })
scene:add_child(gr.box { min = { -9, 0, -2.3 }, max = { 9, 0.28, -2.22 }, edge = 0.03, material = gr.openpbr_material { base_color = { 0.5, 0.44, 0.37 } } })

gr.render {
    node = scene, file = 'lamp.png', width = 400, height = 400, eye = { 2.0, 2.5, 6.6 }, target = { 0, 1.62, 0 }, fov = 37,
    integrator = 'path', denoise = true, tone = 'filmic', exposure = 0.2, max_depth = 4, clamp = 10, background = { 0.02, 0.02, 0.03 },
    lights = { gr.spherical_light { position = { 0, 1.75, 0 }, radius = 0.05, emission = { 820, 500, 225 }, visible = true }, gr.sky_light { sky = { 0.05, 0.07, 0.12 } } },
}
