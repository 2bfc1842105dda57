-- The Cornell box of Embree's tutorials (models/cornell_box.obj and .ecs): white blocks and walls of albedo 1, one red and
-- one green, open in front, with a light without extent.
local function matte(r, g, b)
    return gr.material { kd = { r, g, b }, two_sided = true }
end
local white, red, green = matte(1, 1, 1), matte(1, 0, 0), matte(0, 1, 0)
local room = gr.node('room')
local function face(material, a, b, c, d)
    room:add_child(gr.mesh(material, { a, b, c, d }, { { 0, 1, 2, 3 } }))
end
face(white, { 552.8, 0, 0 }, { 0, 0, 0 }, { 0, 0, 559.2 }, { 549.6, 0, 559.2 })
face(white, { 0, 548.8, 0 }, { 0, 548.8, 559.2 }, { 556, 548.8, 559.2 }, { 556, 548.8, 0 })
face(white, { 556, 548.8, 559.2 }, { 0, 548.8, 559.2 }, { 0, 0, 559.2 }, { 549.6, 0, 559.2 })
face(green, { 0, 548.8, 559.2 }, { 0, 548.8, 0 }, { 0, 0, 0 }, { 0, 0, 559.2 })
face(red, { 556, 548.8, 0 }, { 556, 548.8, 559.2 }, { 549.6, 0, 559.2 }, { 552.8, 0, 0 })
local function block(height, corners)
    local verts, faces = {}, { { 4, 5, 6, 7 } }
    for _, y in ipairs { 0, height } do
        for _, c in ipairs(corners) do verts[#verts + 1] = { c[1], y, c[2] } end
    end
    for i = 0, 3 do faces[#faces + 1] = { i, (i + 1) % 4, (i + 1) % 4 + 4, i + 4 } end
    room:add_child(gr.mesh(white, verts, faces))
end
block(165, { { 130, 65 }, { 82, 225 }, { 240, 272 }, { 290, 114 } })
block(330, { { 423, 247 }, { 265, 296 }, { 314, 456 }, { 472, 406 } })
gr.render {
    node = room, file = 'embree_box.png', width = 128, height = 128, integrator = 'path',
    eye = { 278, 273, -800 }, target = { 278, 273, 0 }, fov = 37, background = { 0, 0, 0 },
    lights = { gr.light { position = { 213, 300, 227 }, colour = { 1, 1, 1 }, intensity = 100000 } },
}
