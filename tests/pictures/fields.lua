-- Functions in the place of numbers: a sky, the colour of a light by direction, and a fog with its colour.
local scene = gr.node 'scene'
scene:add_child(gr.plane { normal = { 0, 1, 0 }, material = gr.material { kd = { 0.6, 0.6, 0.6 } } })
scene:add_child(gr.sphere { centre = { 0, 0.5, 0 }, radius = 0.5, material = gr.material { kd = { 0.8, 0.3, 0.2 } } })
local function sky(d)
    return gr.mix(gr.vec(1, 0.9, 0.8), gr.vec(0.2, 0.4, 0.9), gr.smoothstep(0, 0.5, d.y))
end
local function stripes(d)
    if math.sin(20 * d.x) > 0 then return { 1, 0.8, 0.5 } end
    return 0.05
end
local function cloud(p)
    return 6 * gr.max(0.0, gr.turbulence(p * 1.5, 3) - 0.5 - 0.4 * math.abs(p.y - 1.6))
end
local fog = gr.fog_field { corner = { -3, 0.5, -3 }, size = { 6, 2.2, 6 }, density = cloud,
    colour = function(p, s) return gr.vec(0.9, 0.9, 1) * (0.5 + 0.2 * p.y) + 0.1 * s.view.z end }
local lights = { gr.light { position = { 1, 3, 2 }, colour = stripes } }
gr.render { node = scene, file = 'fields.png', width = 64, height = 48, eye = { 0, 1.2, 6 }, target = { 0, 1, 0 }, fov = 40,
    background = sky, fog = fog, lights = lights }
gr.render { node = scene, file = 'fields-sky.png', width = 64, height = 48, eye = { 0, 1.2, 6 }, target = { 0, 1, 0 }, fov = 40,
    background = sky, lights = { gr.sky_light { sky = sky, samples = 2 },
        gr.disc_light { position = { 0, 2, 1 }, normal = { 0, -1, 0 }, radius = 0.2, emission = { 4, 4, 4 }, colour = stripes, samples = 2 } } }
gr.render { node = scene, file = 'fields-path.png', width = 32, height = 24, eye = { 0, 1.2, 6 }, target = { 0, 1, 0 }, fov = 40,
    integrator = 'path', spp = 4, background = sky, fog = fog, lights = lights }
