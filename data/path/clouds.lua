-- TITLE: Clouds from one Lua function
-- OPTIONS: --spp 16 --denoise
-- The density of the clouds is one function of the point: heaps of noise that fade to their edges. gray finds its bounds
-- in the cells of the box. The sun and a clear sky light them and the land below.
local function density(p)
    local q, heap, size = p * gr.vec(.32, .45, .32) + gr.vec(3.1, 0, 1.7), 0, 1
    for _ = 1, 4 do -- octaves of noise
        heap = heap + size * gr.noise(q)
        q, size = q * 2.03, size * .5
    end
    local low = gr.smoothstep(2.0, 2.5, p.y + .35 * gr.noise(p * .9)) -- uneven below, open above
    return 3 * gr.clamp(1.6 * heap + .12 - .28 * (p.y - 2.4), 0, 1) * low
end

-- Meadows and woods, and hills at the horizon.
local function green(p)
    local wood = gr.smoothstep(-.1, .15, gr.noise(p * .35) + .5 * gr.noise(p * 1.1) + .35 * gr.noise(p * 3.7) + .3 * gr.noise(p * 9))
    local crops = gr.mix(gr.vec(.17, .165, .075), gr.vec(.095, .13, .05), gr.smoothstep(-.15, .15, gr.noise(p * gr.vec(.55, 1, .9) + 7)))
    return gr.mix(crops, gr.vec(.045, .065, .028), wood) * (1 + .25 * gr.noise(p * 20))
end
local scene, land = gr.node('land'), gr.material { kd = green }
scene:add_child(gr.plane { normal = { 0, 1, 0 }, material = land })
for _, h in ipairs { { -22, -30, 15, 1.6 }, { -6, -38, 18, 2.2 }, { 12, -34, 14, 1.5 }, { 27, -28, 14, 1.9 } } do
    local hill = gr.sphere(land)
    hill:scale(h[3], h[4], 9)
    hill:translate(h[1], 0, h[2])
    scene:add_child(hill)
end
gr.render { node = scene, file = 'clouds.png', width = 480, height = 300, max_depth = 10, integrator = 'path', eye = { 0, 1.5, 16 },
    target = { 0, 3.7, 0 }, fov = 50, exposure = -0.85, tone = 'filmic',
    lights = { gr.sun_light { sun = { .6, .8, .5 }, colour = { 3, 2.85, 2.55 } } },
    background = gr.clear_sky { sun = { .6, .8, .5 }, turbidity = 2.2 },
    medium = gr.medium { albedo = { .998, .998, .998 }, distance = .5, g = .5, density = density, corner = { -12, 1.9, -16 },
        size = { 24, 3.6, 22 } } }
