-- The Cornell box of data/path/cornell.lua with a mirror and a ball of glass in place of the blocks.
local function matte(r, g, b)
    return gr.material { kd = { r, g, b }, two_sided = true }
end
local white, red, green = matte(.73, .73, .73), matte(.63, .065, .05), matte(.14, .45, .091)
local lamp = gr.material { two_sided = true, kd = { .78, .78, .78 }, emission = { 18.4, 15.6, 8 } }
local room = gr.node('room')

local function wall(material, corner, along, up)
    room:add_child(gr.rectangle { material = material, corner = corner, along = along, up = up })
end
wall(white, { 0, 0, 0 }, { 5.528, 0, 0 }, { 0, 0, -5.592 })
wall(white, { 0, 0, -5.592 }, { 5.528, 0, 0 }, { 0, 5.488, 0 })
wall(red, { 0, 0, 0 }, { 0, 0, -5.592 }, { 0, 5.488, 0 })
wall(green, { 5.528, 0, 0 }, { 0, 0, -5.592 }, { 0, 5.488, 0 })
wall(white, { 0, 5.488, 0 }, { 5.528, 0, 0 }, { 0, 0, -2.27 })
wall(white, { 0, 5.488, -3.32 }, { 5.528, 0, 0 }, { 0, 0, -2.272 })
wall(white, { 0, 5.488, -2.27 }, { 2.13, 0, 0 }, { 0, 0, -1.05 })
wall(white, { 3.43, 5.488, -2.27 }, { 2.098, 0, 0 }, { 0, 0, -1.05 })
wall(lamp, { 2.13, 5.488, -2.27 }, { 1.3, 0, 0 }, { 0, 0, -1.05 })
room:add_child(gr.sphere { centre = { 1.65, 1.1, -3.6 }, radius = 1.1,
    material = gr.material { kd = { 0, 0, 0 }, ks = { .95, .95, .95 }, reflect = 1 } })
room:add_child(gr.sphere { centre = { 3.8, 1, -1.9 }, radius = 1,
    material = gr.difresnel_material(gr.rr_material({ 0, 0, 0 }, { 1, 1, 1 }, 150, 1, 1, 1.5)) })
gr.render {
    node = room, file = 'spheres.png', width = 128, height = 128, integrator = 'path',
    eye = { 2.78, 2.73, 8 }, target = { 2.78, 2.73, 0 }, fov = 39.3, background = { 0, 0, 0 },
}
