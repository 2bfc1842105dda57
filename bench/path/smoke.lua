-- A plume of smoke over a floor, from the grid that bench/path/smoke_grid.py writes, below a window of light.
local function matte(r, g, b) return gr.material { kd = { r, g, b }, two_sided = true } end
local yard = gr.node('yard')
yard:add_child(gr.rectangle { material = matte(.4, .4, .38), corner = { -10, -1, 10 }, along = { 20, 0, 0 }, up = { 0, 0, -20 } })
yard:add_child(gr.rectangle { material = gr.material { two_sided = true, kd = { 0, 0, 0 }, emission = { 12, 11, 10 } },
    corner = { 1.5, 3, 1 }, along = { 1.5, -1.5, 0 }, up = { 0, 0, -2 } })
yard:add_child(gr.rectangle { material = gr.material { two_sided = true, kd = { 0, 0, 0 }, emission = { .2, .3, .5 } },
    corner = { -10, -1, -5 }, along = { 20, 0, 0 }, up = { 0, 10, 0 } })
yard:add_child(gr.box { min = { -1, -1, -1 }, max = { 1, 1, 1 },
    medium = gr.medium { scattering = { 11.4, 11.4, 11.4 }, absorption = { .6, .6, .6 }, corner = { -1, -1, -1 },
        size = 2, density = '../../build/bench/path/smoke.nrrd' } })
gr.render {
    node = yard, file = 'smoke.png', width = 128, height = 128, integrator = 'path', max_depth = 64,
    eye = { 0, .4, 4.6 }, target = { 0, .05, 0 }, fov = 34, background = { 0, 0, 0 },
}
