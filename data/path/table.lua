-- Glass, gold and lacquer on a table: layered materials in the light of a window and a lamp.
-- TITLE: Glass, gold and lacquer on a table
-- OPTIONS: --spp 56

local oak = gr.openpbr_material{
    base_color = gr.mix_texture({0.30, 0.17, 0.08}, {0.20, 0.10, 0.045}, gr.wood_texture(0.6, 9)),
    base_diffuse_roughness = 0.4,
    specular_roughness = 0.5,
    coat_weight = 0.5,
    coat_roughness = 0.15,
    glossy_samples = 2,
}
local wall = gr.openpbr_material{base_color = {0.62, 0.60, 0.55}, specular_weight = 0, base_diffuse_roughness = 0.6}
local gold = gr.metal_material{metal = 'gold', roughness = 0.2}
local brushed = gr.metal_material{metal = 'aluminium', roughness = 0.35, anisotropy = 0.9, tangent = {0, 1, 0}}
local copper = gr.metal_material{metal = 'copper'}
local glass = gr.openpbr_material{transmission_weight = 1, specular_roughness = 0}
local frosted = gr.openpbr_material{
    transmission_weight = 1,
    transmission_color = {0.45, 0.75, 0.55},
    transmission_depth = 1,
    specular_roughness = 0.35,
}
local lacquer = gr.openpbr_material{
    base_color = {0.45, 0.012, 0.02},
    specular_weight = 0.3,
    coat_weight = 1,
    coat_ior = 1.55,
}
local velvet = gr.openpbr_material{
    base_color = {0.02, 0.025, 0.12},
    specular_weight = 0,
    fuzz_weight = 1,
    fuzz_color = {0.45, 0.5, 0.9},
    fuzz_roughness = 0.3,
}

local scene = gr.node('table')
local function add(node)
    scene:add_child(node)
    return node
end
local function ball(name, material, x, z, radius)
    add(gr.sphere{name = name, material = material, centre = {x, radius, z}, radius = radius})
end

add(gr.cube{name = 'top', material = oak, corner = {-7, -0.5, -4}, size = {14, 0.5, 8}})
add(gr.cube{name = 'wall', material = wall, corner = {-14, -4, -7}, size = {28, 16, 0.5}})
ball('gold', gold, -3.1, 0.2, 1)
ball('glass', glass, -0.9, 1.1, 0.9)
ball('lacquer', lacquer, 1.2, 0, 1.1)
ball('frosted glass', frosted, 3.4, 0.7, 0.95)
ball('copper', copper, 0.25, 2.45, 0.35)
ball('velvet', velvet, 2.35, 2.3, 0.45)
add(gr.cylinder{name = 'tin', material = brushed, from = {-1.7, 0, -1.9}, to = {-1.7, 2.4, -1.9}, radius = 0.7})

-- The window: a large area light on the left. The lamp: a ball on the right.
local window = gr.area_light{
    colour = {1, 1, 1}, emission = {6, 6.6, 7.5}, corner = {-9, 2, 5}, v1 = {0, 5, 0}, v2 = {3, 0, 3}, visible = true,
}
local lamp = gr.spherical_light{colour = {1, 1, 1}, emission = {11.5, 8.6, 5.4}, position = {5, 5.5, 3}, radius = 1, visible = true}

gr.render{
    node = scene,
    file = 'table.png',
    width = 480,
    height = 270,
    integrator = 'path',
    denoise = true,
    eye = {0.4, 3.4, 11},
    target = {0.1, 0.75, 0},
    fov = 27,
    lights = {window, lamp},
    background = {0.05, 0.055, 0.065},
    exposure = .7,
    filter = 'gaussian',
}
