-- A square tumbler of glass with milk, on a table below a window of light.
local function matte(r, g, b) return gr.material { kd = { r, g, b }, two_sided = true } end
local function clear(index)
    return gr.difresnel_material(gr.rr_material({ 0, 0, 0 }, { 1, 1, 1 }, 150, 1, 1, index))
end
local table_top = gr.node('table')
table_top:add_child(gr.rectangle { material = matte(.4, .25, .15), corner = { -10, 0, 10 }, along = { 20, 0, 0 }, up = { 0, 0, -20 } })
table_top:add_child(gr.rectangle { material = gr.material { two_sided = true, kd = { 0, 0, 0 }, emission = { 6, 6, 6 } },
    corner = { -2.5, 4, 1.5 }, along = { 3, 0, 0 }, up = { 0, 1.5, -3 } })
table_top:add_child(gr.rectangle { material = gr.material { two_sided = true, kd = { 0, 0, 0 }, emission = { .6, .7, .8 } },
    corner = { -10, 0, -4 }, along = { 20, 0, 0 }, up = { 0, 8, 0 } })
table_top:add_child(gr.box { material = clear(1.5), min = { -.6, .01, -.6 }, max = { .6, 2, .6 } })
table_top:add_child(gr.box { material = clear(1.33), min = { -.5, .2, -.5 }, max = { .5, 1.9, .5 },
    medium = gr.medium { scattering = { 19.98, 19.9, 19.6 }, absorption = { .02, .1, .4 }, g = .6 } })
gr.render {
    node = table_top, file = 'milk.png', width = 128, height = 128, integrator = 'path', max_depth = 256,
    eye = { 2.4, 2.2, 4.2 }, target = { 0, .95, 0 }, fov = 34, background = { 0, 0, 0 },
}
