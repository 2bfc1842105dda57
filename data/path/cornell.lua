-- TITLE: The Cornell box
-- OPTIONS: --spp 24 --denoise
-- The measured box of Cornell University's Program of Computer Graphics (Goral, Torrance, Greenberg, Battaile 1984; data
-- of 1998), with colours as linear RGB. The walls illuminate each other. A unit is a decimetre.
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

-- The lamp fills a hole of the ceiling.
wall(white, { 0, 5.488, 0 }, { 5.528, 0, 0 }, { 0, 0, -2.27 })
wall(white, { 0, 5.488, -3.32 }, { 5.528, 0, 0 }, { 0, 0, -2.272 })
wall(white, { 0, 5.488, -2.27 }, { 2.13, 0, 0 }, { 0, 0, -1.05 })
wall(white, { 3.43, 5.488, -2.27 }, { 2.098, 0, 0 }, { 0, 0, -1.05 })
wall(lamp, { 2.13, 5.488, -2.27 }, { 1.3, 0, 0 }, { 0, 0, -1.05 })

local function block(width, height, x, z, degrees)
    local box = gr.box { material = white, min = { -width / 2, 0, -width / 2 }, max = { width / 2, height, width / 2 } }
    box:rotate('y', degrees)
    box:translate(x, 0, z)
    room:add_child(box)
end
block(1.65, 1.65, 3.68, -1.69, -17)
block(1.65, 3.3, 1.86, -3.51, 17)

gr.render {
    node = room, file = 'cornell.png', width = 400, height = 400, integrator = 'path',
    eye = { 2.78, 2.73, 8 }, target = { 2.78, 2.73, 0 }, fov = 39.3, background = { 0, 0, 0 }, exposure = 1, tone = 'filmic',
}
