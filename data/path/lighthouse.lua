-- TITLE: A lighthouse in fog
-- OPTIONS: --spp 24 --denoise
-- The lamp behind its panes sends two beams into the fog of a sea at night. The fog is a medium that ends above the
-- lamp; spots and lamp are seen by the light that it scatters.
local scene = gr.node('coast')

local function matte(r, g, b) return gr.material { kd = { r, g, b } } end
local white, red, rock, slate = matte(.75, .74, .70), matte(.55, .06, .05), matte(.10, .09, .08), matte(.08, .09, .10)

-- the sea, and the rock that the tower stands on
scene:add_child(gr.plane { normal = { 0, 1, 0 }, material = gr.openpbr_material {
    base_color = { .01, .025, .03 }, specular_roughness = .25 } })
for i, r in ipairs { { 0, -1.2, 0, 4.2 }, { 2.6, -1.6, 1.4, 2.8 }, { -2.9, -1.7, .8, 2.7 }, { .5, -1.8, 2.9, 2.6 } } do
    scene:add_child(gr.sphere { name = 'rock' .. i, centre = { r[1], r[2], r[3] }, radius = r[4], material = rock })
end

-- the tower, in bands
local function radius(y) return 1.15 - .045 * y end
for i = 0, 4 do
    local y = 2.2 + 1.7 * i
    scene:add_child(gr.cone { from = { 0, y, 0 }, to = { 0, y + 1.7, 0 }, from_radius = radius(y), radius = radius(y + 1.7),
        material = i % 2 == 0 and white or red })
end
-- gallery, lantern, roof
scene:add_child(gr.cylinder { from = { 0, 10.7, 0 }, to = { 0, 10.95, 0 }, radius = 1.05, material = slate })
for i = 1, 10 do
    local a = 2 * math.pi * i / 10
    local x, z = .62 * math.cos(a), .62 * math.sin(a)
    scene:add_child(gr.cylinder { from = { x, 10.95, z }, to = { x, 12.2, z }, radius = .03, material = slate })
end
scene:add_child(gr.cone { from = { 0, 12.2, 0 }, to = { 0, 13.1, 0 }, from_radius = .85, radius = .02, material = slate })
-- a hut
scene:add_child(gr.cube { corner = { 2.1, .5, .9 }, size = { 1.7, 1.4, 1.5 }, material = white })
scene:add_child(gr.cube { corner = { 2, 1.9, .8 }, size = { 1.9, .15, 1.7 }, material = slate })

local lamp = { 0, 11.55, 0 }
local lights = {
    gr.light { position = lamp, colour = { 1, .86, .6 }, intensity = 30 },
    gr.spot_light { position = lamp, direction = { 1, -.12, .35 }, colour = { 1, .9, .7 }, outer = 7, intensity = 5200 },
    gr.spot_light { position = lamp, direction = { -1, -.10, -.30 }, colour = { 1, .9, .7 }, outer = 7, intensity = 5200 },
    gr.light { position = { 2.9, 1.3, 2.75 }, colour = { 1, .6, .25 }, intensity = 1.6 },
    gr.directional_light { direction = { -.4, -1, -.5 }, colour = { .006, .008, .014 } },
}
gr.render { node = scene, file = 'lighthouse.png', width = 480, height = 360, max_depth = 6, clamp = 2, integrator = 'path', eye = { -3, 3.2, 21 },
    target = { 0, 6.6, 0 }, fov = 42, lights = lights, background = { .002, .003, .006 }, exposure = 1, tone = 'filmic',
    medium = gr.medium { albedo = { .9, .92, .95 }, distance = 60, g = .5, top = 22 } }
