-- A closed hall full of fog, lit by a small round lamp and by a spot whose beam is seen.
local function matte(r, g, b) return gr.material { kd = { r, g, b }, two_sided = true } end
local hall = gr.node('hall')
local function wall(material, corner, along, up)
    hall:add_child(gr.rectangle { material = material, corner = corner, along = along, up = up })
end
local white = matte(.6, .58, .55)
wall(matte(.35, .3, .25), { -4, 0, 4 }, { 8, 0, 0 }, { 0, 0, -12 })
wall(white, { -4, 5, 4 }, { 8, 0, 0 }, { 0, 0, -12 })
wall(white, { -4, 0, -8 }, { 8, 0, 0 }, { 0, 5, 0 })
wall(matte(.5, .2, .15), { -4, 0, 4 }, { 0, 0, -12 }, { 0, 5, 0 })
wall(matte(.15, .3, .5), { 4, 0, 4 }, { 0, 0, -12 }, { 0, 5, 0 })
wall(white, { -4, 0, 4 }, { 8, 0, 0 }, { 0, 5, 0 })
for i = 0, 5 do
    local x, z = i % 2 * 4 - 2, -1 - 2.5 * (i // 2)
    hall:add_child(gr.box { material = white, min = { x - .3, 0, z - .3 }, max = { x + .3, 3.5, z + .3 } })
end
local lamp = gr.spherical_light { position = { -1, 2.6, -3 }, radius = .1, emission = { 120, 96, 64 }, colour = { 1, 1, 1 }, visible = true }
local spot = gr.spot_light { position = { 3, 4.8, -5 }, target = { -1.2, 0, -1 }, colour = { 1, 1, 1 }, intensity = 160, inner = 12, outer = 12 }
gr.render {
    node = hall, file = 'fog.png', width = 128, height = 128, integrator = 'path', lights = { lamp, spot },
    medium = gr.medium { scattering = { .1, .1, .1 }, absorption = { .01, .01, .01 }, g = .5 },
    eye = { 0, 2, 3.8 }, target = { 0, 2.1, -4 }, fov = 60, background = { 0, 0, 0 },
}
