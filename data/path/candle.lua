-- Three wax candles: the light of their flames goes under the surface and comes out of their sides.
-- TITLE: Wax candles
-- OPTIONS: --spp 48

local function wax(colour, radius)
    return gr.openpbr_material{
        subsurface_weight = 1,
        subsurface_color = colour,
        subsurface_radius = radius,
        subsurface_radius_scale = {1, 0.65, 0.45},
        specular_roughness = 0.35,
        specular_ior = 1.45,
    }
end
local ivory = wax({0.93, 0.84, 0.66}, 0.4)
local red = wax({0.75, 0.12, 0.07}, 0.5)
local oak = gr.openpbr_material{
    base_color = gr.mix_texture({0.28, 0.16, 0.08}, {0.18, 0.09, 0.045}, gr.wood_texture(0.6, 9)),
    base_diffuse_roughness = 0.4,
    specular_roughness = 0.4,
}
local wall = gr.openpbr_material{base_color = {0.5, 0.45, 0.4}, specular_weight = 0}
local soot = gr.openpbr_material{base_color = {0.02, 0.015, 0.01}, specular_weight = 0}
local fire = gr.material{kd = {0, 0, 0}, emission = {40, 22, 8}}

local scene = gr.node('candles')
scene:add_child(gr.cube{name = 'table', material = oak, corner = {-12, -0.5, -5}, size = {24, 0.5, 14}})
scene:add_child(gr.cube{name = 'wall', material = wall, corner = {-20, -5, -7}, size = {40, 25, 0.5}})

-- A candle has a hollow around its wick, where the wax has melted.
local function candle(name, material, x, z, radius, height)
    local h, r = height, radius
    local node = gr.node(name)
    node:add_child(gr.lathe(material, {
        {0, h - 0.38}, {0.3 * r, h - 0.36}, {0.62 * r, h - 0.2}, {0.8 * r, h - 0.02}, {0.9 * r, h}, {0.97 * r, h - 0.05}, {r, h - 0.16},
        {r, 0.06}, {0.97 * r, 0}, {0, 0},
    }))
    node:add_child(gr.cylinder{material = soot, from = {0, h - 0.5, 0}, to = {0.03, h + 0.06, 0}, radius = 0.03})
    local flame = gr.lathe(fire, {
        {0, 0}, {0.06, 0.03}, {0.1, 0.1}, {0.115, 0.2}, {0.1, 0.33}, {0.07, 0.48}, {0.035, 0.63}, {0.012, 0.74}, {0, 0.8},
    })
    flame:translate(0.03, h + 0.05, 0)
    node:add_child(flame)
    node:translate(x, 0, z)
    scene:add_child(node)
end
candle('tall', ivory, -1.75, -0.5, 0.9, 2.6)
candle('middle', red, 0.55, -1.2, 0.8, 2)
candle('short', ivory, 1.5, 0.9, 1.05, 1.2)

gr.render{
    node = scene,
    file = 'candle.png',
    width = 360,
    height = 270,
    integrator = 'path',
    denoise = true,
    eye = {0.3, 3.2, 11},
    target = {0, 1.35, 0},
    fov = 26,
    background = {0.09, 0.12, 0.18},
    lights = {gr.sky_light{sky = {0.09, 0.12, 0.18}}},
    tone = 'filmic',
    exposure = 0.3,
    bloom = 0.15,
    filter = 'gaussian',
}
