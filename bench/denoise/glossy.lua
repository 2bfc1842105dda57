-- A box with a rough metal floor, a polished ball, a ball of glass and a textured wall.
local function matte(r, g, b) return gr.material { kd = { r, g, b }, two_sided = true } end
local room = gr.node('room')
local function wall(material, corner, along, up)
    room:add_child(gr.rectangle { material = material, corner = corner, along = along, up = up })
end
local white = matte(.7, .7, .68)
wall(gr.material { two_sided = true, kd = { .1, .1, .1 }, ks = { .75, .72, .68 }, reflect = .9, roughness = .4 },
    { -3, 0, 3 }, { 6, 0, 0 }, { 0, 0, -6 })
wall(white, { -3, 4, 3 }, { 6, 0, 0 }, { 0, 0, -6 })
wall(gr.material { two_sided = true, kd = gr.texture { file = '../../textures/tiles.png', tiles = { 3, 2 } } },
    { -3, 0, -3 }, { 6, 0, 0 }, { 0, 4, 0 })
wall(matte(.6, .15, .12), { -3, 0, 3 }, { 0, 0, -6 }, { 0, 4, 0 })
wall(matte(.15, .45, .2), { 3, 0, 3 }, { 0, 0, -6 }, { 0, 4, 0 })
wall(white, { -3, 0, 3 }, { 6, 0, 0 }, { 0, 4, 0 })
wall(gr.material { two_sided = true, kd = { .5, .5, .5 }, emission = { 9, 8.4, 7.5 } }, { -.8, 3.99, .8 }, { 1.6, 0, 0 },
    { 0, 0, -1.6 })
room:add_child(gr.sphere { centre = { -1.2, .9, -.9 }, radius = .9,
    material = gr.material { kd = { .02, .02, .02 }, ks = { .95, .8, .45 }, reflect = 1, roughness = .25 } })
room:add_child(gr.sphere { centre = { 1.2, .75, .1 }, radius = .75,
    material = gr.difresnel_material(gr.rr_material({ 0, 0, 0 }, { 1, 1, 1 }, 150, 1, 1, 1.5)) })
gr.render {
    node = room, file = 'glossy.png', width = 128, height = 128, integrator = 'path',
    eye = { 0, 2, 2.9 }, target = { 0, 1.5, -2 }, fov = 75, background = { 0, 0, 0 },
}
