-- TITLE: Morning sun
-- OPTIONS: --spp 48
-- A room that is lit by nothing but the sun and the clear sky in its windows: a patch of sunlight on the floor lights
-- walls and ceiling, and the blue of the sky fills the shadows.
local when = { hour = 9.5, day = 110, latitude = 48 }
local function matte(r, g, b) return gr.material { kd = { r, g, b }, two_sided = true } end
local plaster, oak = matte(.78, .76, .72), matte(.5, .36, .22)
local room = gr.node('room')
local function box(material, min, max) room:add_child(gr.box { material = material, min = min, max = max }) end

-- Six metres wide, five deep, three high; the windows are in the wall at x = 3.
box(gr.material { kd = gr.texture { file = '../../textures/parquet.png', tiles = { 4, 4 } } }, { -3, -.1, -3 }, { 3, 0, 3 })
box(plaster, { -3.2, 3, -3.2 }, { 3.2, 3.2, 3.2 })
box(plaster, { -3.2, 0, -3.2 }, { 3.2, 3, -3 })
box(plaster, { -3.2, 0, 3 }, { 3.2, 3, 3.2 })
box(matte(.55, .62, .6), { -3.2, 0, -3 }, { -3, 3, 3 })
box(plaster, { 3, 0, -3 }, { 3.2, .5, 3 })
box(plaster, { 3, 2.6, -3 }, { 3.2, 3, 3 })
for _, z in ipairs { -3, -.9, .4, 2.3 } do
    box(plaster, { 3, .5, z }, { 3.2, 2.6, z + (z == -.9 and 1.3 or .7) })
end
for _, z in ipairs { -1.6, 1.35 } do -- bars and sills
    box(oak, { 3.04, .5, z - .03 }, { 3.1, 2.6, z + .03 })
end
box(oak, { 2.8, .44, -2.4 }, { 3.02, .5, 2.4 })

-- A table with a pot, a ball and a bowl; a picture on the wall.
box(oak, { -1, .70, -1.8 }, { 1, .76, -.6 })
for _, x in ipairs { -.95, .88 } do
    for _, z in ipairs { -1.75, -.72 } do box(oak, { x, 0, z }, { x + .07, .70, z + .07 }) end
end
local verts, normals, faces, corners = require('teapot').mesh(8)
local pot = gr.vn_mesh(matte(.12, .3, .42), verts, normals, faces, corners)
pot:scale(.11, .11, .11)
pot:rotate('y', 30)
pot:translate(-.3, .76, -1.2)
room:add_child(pot)
room:add_child(gr.sphere { centre = { .45, .9, -1.05 }, radius = .14, material = matte(.75, .35, .06) })
room:add_child(gr.sphere { centre = { .2, .86, -1.4 }, radius = .1, material = matte(.7, .62, .1) })
box(gr.image_material { material = matte(.8, .8, .8), image = '../../textures/painting.png' },
    { -.8, 1.3, -2.99 }, { .6, 2.2, -2.95 })

gr.render {
    node = room, file = 'sunlit.png', width = 480, height = 360, integrator = 'path', spp = 512, denoise = true,
    eye = { -1.7, 1.5, 2.85 }, target = { .5, 1.05, -1.2 }, fov = 58, exposure = .6, tone = 'filmic',
    lights = { gr.sun_light { hour = when.hour, day = when.day, latitude = when.latitude, colour = { 14, 12.4, 9.6 } } },
    background = gr.clear_sky { hour = when.hour, day = when.day, latitude = when.latitude, intensity = .8 },
}
