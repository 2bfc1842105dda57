-- A room lit by 200 small lamps in rows below its ceiling, with pillars that throw soft shadows.
local function matte(r, g, b) return gr.material { kd = { r, g, b }, two_sided = true } end
local room = gr.node('room')
local function wall(material, corner, along, up)
    room:add_child(gr.rectangle { material = material, corner = corner, along = along, up = up })
end
local white = matte(.72, .7, .66)
wall(gr.material { two_sided = true, kd = gr.texture { file = '../../textures/parquet.png', tiles = { 5, 6 } } },
    { -5, 0, 3 }, { 10, 0, 0 }, { 0, 0, -13 })
wall(white, { -5, 4, 3 }, { 10, 0, 0 }, { 0, 0, -13 })
wall(white, { -5, 0, -10 }, { 10, 0, 0 }, { 0, 4, 0 })
wall(matte(.6, .2, .15), { -5, 0, 3 }, { 0, 0, -13 }, { 0, 4, 0 })
wall(matte(.2, .35, .6), { 5, 0, 3 }, { 0, 0, -13 }, { 0, 4, 0 })
wall(white, { -5, 0, 3 }, { 10, 0, 0 }, { 0, 4, 0 })
for i = 0, 9 do
    local z = -1 - 2 * (i // 2)
    room:add_child(gr.box { material = white, min = { i % 2 * 5 - 2.7, 0, z - .2 }, max = { i % 2 * 5 - 2.3, 4, z + .2 } })
end
for i = 0, 199 do
    local hue = i * .618 % 1
    local colour = { 20 + 16 * math.cos(6.2832 * hue), 20, 20 - 16 * math.cos(6.2832 * hue) }
    room:add_child(gr.sphere { centre = { -4.5 + i % 10, 3.6, 2 - i // 10 * .6 }, radius = .05,
        material = gr.material { kd = { 0, 0, 0 }, emission = colour } })
end
gr.render {
    node = room, file = 'lamps.png', width = 128, height = 128, integrator = 'path',
    eye = { 1.2, 1.7, 2.5 }, target = { -.4, 1.7, -5 }, fov = 60, background = { 0, 0, 0 },
}
