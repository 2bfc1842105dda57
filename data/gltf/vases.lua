-- TITLE: Vases that go to Blender and come back
-- gray writes the scene as glTF, Blender adds handles and paints one vase, gray renders what Blender writes:
--   gray vases.lua -o vases.glb
--   blender -b --python vases.py -- vases.glb vases-back.glb
--   gray vases-back.glb
-- Author: gray project

local function clay(r, g, b, roughness) return gr.openpbr_material{base_color = {r, g, b}, specular_roughness = roughness} end
local function stripes(p)
    if math.floor(6 * p.y) % 2 < 1 then return {0.75, 0.3, 0.12} end
    return {0.9, 0.82, 0.66}
end

local profile = {}
for i = 0, 32 do profile[i + 1] = {0.52 + 0.3 * math.sin(3.6 * i / 32 + 0.2) - 0.12 * i / 32, 1.85 * i / 32} end

local function vase(name, x, z, size, material)
    local node = gr.lathe{name = name, points = profile, material = material}
    node:scale(size, size, size)
    node:translate(x, 0, z)
    return node
end

local table_top = gr.box{name = 'table', min = {-3.5, -0.2, -1.6}, max = {3.5, 0, 1.6}, material = clay(0.35, 0.22, 0.14, 0.6)}
local wall = gr.rectangle{name = 'wall', corner = {-7, -3, -3}, along = {14, 0, 0}, up = {0, 8, 0}, material = clay(0.62, 0.66, 0.7, 0.9)}
gr.render{
    node = gr.node{name = 'scene', children = {
        table_top, wall,
        vase('striped', -1.9, 0, 1, gr.openpbr_material{base_color = stripes, specular_roughness = 0.3}),
        vase('plain', 0, 0.2, 1.15, clay(0.8, 0.8, 0.78, 0.4)),
        vase('gold', 1.9, 0, 0.9, gr.openpbr_material{base_color = {1, 0.78, 0.34}, base_metalness = 1, specular_roughness = 0.25})}},
    width = 640, height = 400, eye = {0, 2.2, 7}, view = {0, -0.19, -1}, fov = 36, colour = 'linear', integrator = 'path', spp = 64,
    denoise = true,
    lights = {gr.light{position = {-4, 6, 5}, colour = {1, 0.95, 0.9}, intensity = 55},
              gr.light{position = {5, 4, 4}, colour = {0.7, 0.8, 1}, intensity = 20}}}
