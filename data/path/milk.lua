-- Water, milk and juice in three glasses: what is inside absorbs and scatters light.
-- TITLE: Water, milk and juice
-- OPTIONS: --spp 32

local glass = gr.openpbr_material{transmission_weight = 1, specular_roughness = 0}
-- Liquids reach a little into the wall of their glass, so that the light meets one surface between them.
local water = gr.openpbr_material{transmission_weight = 1, specular_roughness = 0, specular_ior = 1.33}
local juice = gr.openpbr_material{
    transmission_weight = 1,
    specular_roughness = 0,
    specular_ior = 1.34,
    transmission_color = {0.95, 0.66, 0.25},
    transmission_depth = 0.7,
    transmission_scatter = {0.14, 0.13, 0.1},
    transmission_scatter_anisotropy = 0.6,
}
local milk = gr.openpbr_material{
    subsurface_weight = 1,
    subsurface_color = {0.95, 0.93, 0.87},
    subsurface_radius = 0.12,
    subsurface_radius_scale = {1, 0.8, 0.6},
    specular_roughness = 0,
    specular_ior = 1.35,
}
local oak = gr.openpbr_material{
    base_color = gr.mix_texture({0.42, 0.27, 0.15}, {0.33, 0.2, 0.1}, gr.wood_texture(0.6, 9)),
    base_diffuse_roughness = 0.4,
    specular_roughness = 0.5,
}

local scene = gr.node('breakfast')
scene:add_child(gr.cube{name = 'table', material = oak, corner = {-12, -0.5, -5}, size = {24, 0.5, 14}})

local function tumbler(name, liquid, x, z)
    local wall = gr.lathe(glass, {
        {0, 0.02}, {0.66, 0.02}, {0.72, 0.08}, {0.9, 2.36}, {0.87, 2.4}, {0.83, 2.36}, {0.66, 0.32}, {0.58, 0.24}, {0, 0.24},
    })
    local filling = gr.lathe(liquid, {{0, 0.2}, {0.6, 0.2}, {0.69, 0.3}, {0.81, 1.75}, {0, 1.75}})
    local node = gr.node(name)
    node:add_child(wall)
    node:add_child(filling)
    node:translate(x, 0, z)
    scene:add_child(node)
end
tumbler('water', water, -2.1, 0)
tumbler('milk', milk, 0, 0.4)
tumbler('juice', juice, 2.1, 0)

-- As photographers light glass: a bright field behind, and a darker room before it, with a window.
local function room(d)
    local behind, above = gr.smoothstep(-0.6, 0.9, 0.5 * d.y - 0.9 * d.z), gr.smoothstep(0.4, 0.9, d.y)
    return gr.vec(0.9, 0.95, 1) * (0.25 + 0.35 * behind + 0.7 * above)
end
local window = gr.area_light{colour = {1, 1, 1}, emission = {6, 5.7, 5.2}, corner = {-8, 0.5, 4}, v1 = {0, 7, 0}, v2 = {1.2, 0, 2.4}, visible = true}
gr.render{
    node = scene,
    file = 'milk.png',
    width = 360,
    height = 216,
    integrator = 'path',
    denoise = true,
    max_depth = 64,
    eye = {0, 3.2, 10},
    target = {0, 1.15, 0},
    fov = 22,
    background = room,
    lights = {window, gr.sky_light{sky = room}},
    tone = 'filmic',
    exposure = 0.3,
    filter = 'gaussian',
    clamp = 3,
}
