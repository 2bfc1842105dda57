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
    return 4 * gr.clamp(1.6 * heap + .12 - .28 * (p.y - 2.4), 0, 1) * low
end

local scene = gr.node('land')
scene:add_child(gr.plane { normal = { 0, 1, 0 }, material = gr.material { kd = { .07, .085, .04 } } })
gr.render { node = scene, file = 'clouds.png', width = 480, height = 300, max_depth = 10, integrator = 'path', eye = { 0, 1.1, 16 },
    target = { 0, 3.4, 0 }, fov = 50, exposure = -1.1, tone = 'filmic',
    lights = { gr.sun_light { sun = { .7, .55, .35 }, colour = { 5, 4.7, 4.2 } } },
    background = gr.clear_sky { sun = { .7, .55, .35 }, turbidity = 2.2 },
    medium = gr.medium { albedo = { .998, .998, .998 }, distance = .5, g = .5, density = density, corner = { -12, 1.9, -16 },
        size = { 24, 3.6, 22 } } }
