-- TITLE: A light field: glasses on a table before a window
-- A grid of cameras looks from the glasses to the window. The focus is chosen afterwards, without the scene:
--   gray data/teaching/light_field.lua
--   gray view light_field.lf -o glasses.png --focus 2 --aperture 0.09
--   gray view light_field.lf -o window.png --focus 6 --aperture 0.09
--   gray view light_field.lf -o walk.gif --eye=-0.09,0,0:0.09,0,0 --frames 20 --loop
-- Author: gray project

local wood = gr.material{kd = gr.mix_texture({0.5, 0.33, 0.2}, {0.36, 0.22, 0.12}, gr.wood_texture(1.5, 6)), ks = {0.2, 0.2, 0.2}, shininess = 60}
local wall = gr.material{kd = {0.75, 0.7, 0.62}}
local frame = gr.material{kd = {0.9, 0.9, 0.88}, ks = {0.2, 0.2, 0.2}, shininess = 30}
local glass = gr.rr_material({0.02, 0.02, 0.02}, {0.9, 0.9, 0.9}, 200, 0.1, 0.95, 1.5)
local red = gr.material{kd = {0.9, 0.2, 0.1}, ks = {0.4, 0.4, 0.4}, shininess = 80}

local scene = gr.node 'scene'
local function add(node)
    scene:add_child(node)
    return node
end
local function box(material, low, high)
    add(gr.box{material = material, min = low, max = high})
end

-- A tumbler is a cylinder without its inside.
local function tumbler(x, z, radius, height)
    local outer = gr.cylinder{from = {x, 0, z}, to = {x, height, z}, radius = radius}
    local inner = gr.cylinder{from = {x, 0.06, z}, to = {x, height + 0.1, z}, radius = radius - 0.025}
    add(gr.difference('tumbler', outer, inner)):set_material(glass)
end
tumbler(-0.28, -0.05, 0.2, 0.62)
tumbler(0.3, -0.25, 0.17, 0.5)
add(gr.sphere{material = red, centre = {0.02, 0.13, -0.75}, radius = 0.13})
add(gr.sphere{material = red, centre = {-0.62, 0.11, -1.6}, radius = 0.11})
box(wood, {-2.2, -0.1, -2.6}, {2.2, 0, 0.6})

-- The wall with its window, and what is outside: hills, and a sky that grows lighter towards them.
local z = -4
box(wall, {-4, -2, z - 0.2}, {-1.2, 4, z})
box(wall, {1.2, -2, z - 0.2}, {4, 4, z})
box(wall, {-1.2, -2, z - 0.2}, {1.2, -0.2, z})
box(wall, {-1.2, 2, z - 0.2}, {1.2, 4, z})
for _, x in ipairs{-1.2, -0.04, 1.12} do box(frame, {x, -0.2, z - 0.1}, {x + 0.08, 2, z + 0.05}) end
for _, y in ipairs{-0.2, 0.86, 1.92} do box(frame, {-1.2, y, z - 0.1}, {1.2, y + 0.08, z + 0.05}) end
local function landscape(p)
    local height = 1.4 + 0.5 * math.sin(p.x * 0.7) + 0.25 * math.sin(p.x * 1.9 + 1)
    local trees = 0.5 + 0.5 * math.sin(p.x * 9) * math.sin(p.y * 11)
    local hills = gr.vec(0.16, 0.3, 0.1) + gr.vec(0.1, 0.14, 0.04) * trees
    return gr.mix(hills, gr.mix(gr.vec(1, 0.86, 0.66), gr.vec(0.4, 0.6, 0.9), p.y / 5), gr.smoothstep(height, height + 0.06, p.y))
end
local view = gr.material{kd = {0, 0, 0}, emission = landscape, lit = false}
add(gr.rectangle{material = view, corner = {-8, -4, -9}, along = {16, 0, 0}, up = {0, 10, 0}})

gr.light_field{
    node = scene, rows = 5, columns = 5, size = {144, 108}, spacing = 0.045, depth = true, samples = 2, reflect_limit = 1,
    eye = {0, 0.75, 2}, target = {0, 0.42, 0}, fov = 34, ambient = {0.25, 0.25, 0.27}, background = {0, 0, 0},
    lights = {
        gr.light{position = {0, 1.6, -3.6}, colour = {0.55, 0.5, 0.42}, falloff = {1, 0, 0}},
        gr.light{position = {-2, 3, 3}, colour = {0.5, 0.5, 0.5}, falloff = {1, 0, 0}},
    },
}
