-- Scenes for tools/check_gltf.sh: matt surfaces, whose colours other programs compute alike, under each light of glTF.
-- With -D mask=true they are white without light: their pictures are the share of each pixel that is covered.
local function matt(r, g, b)
    if mask then return gr.material{kd = {1, 1, 1}, lit = false, two_sided = true} end
    return gr.openpbr_material{base_color = {r, g, b}, specular_weight = 0}
end
local red, green, blue, white = matt(0.8, 0.2, 0.1), matt(0.2, 0.7, 0.2), matt(0.2, 0.3, 0.8), matt(0.8, 0.8, 0.8)
local floor = gr.rectangle{corner = {-6, 0, 6}, along = {12, 0, 0}, up = {0, 0, -12}, material = white}

local function turned(node, axis, angle, x, y, z)
    local group = gr.node{children = {node}}
    group:rotate(axis, angle)
    group:translate(x, y, z)
    return group
end

local function shapes()
    local squeezed = gr.box{min = {-0.5, -0.5, -0.5}, max = {0.5, 0.5, 0.5}, material = blue}
    squeezed:rotate('z', 30)
    squeezed:scale(1, 2, 1)
    squeezed:translate(3, 1.4, 0)
    return gr.node{children = {
        floor, gr.sphere{centre = {-3, 1, 0}, radius = 1, material = red},
        turned(gr.torus{major = 1, minor = 0.35, material = green}, 'x', 60, 0, 1.2, 0), squeezed,
        gr.cylinder{from = {-2, 0, 3}, to = {-2, 1.5, 3}, radius = 0.5, material = blue},
        gr.cone{from = {2, 1.5, 3}, to = {2, 0, 3}, radius = 0.8, material = red}}}
end

local function solids()
    local block = gr.difference{gr.box{min = {-1, 0, -1}, max = {1, 2, 1}, material = red},
                                gr.sphere{centre = {0, 1, 0}, radius = 1.25, material = green}}
    local lens = gr.intersection{gr.sphere{centre = {0, 1, -0.6}, radius = 1, material = blue},
                                 gr.sphere{centre = {0, 1, 0.6}, radius = 1, material = blue}}
    return gr.node{children = {floor, turned(block, 'y', 35, -2.5, 0, 0), turned(lens, 'y', 60, 2, 0, 1)}}
end

local function crowd()
    local post = gr.node{children = {gr.cylinder{radius = 0.15, material = blue}, gr.sphere{centre = {0, 1.2, 0}, radius = 0.25, material = red}}}
    local all = {floor}
    for i = 0, 24 do all[i + 2] = turned(post, 'z', 3 * i - 36, i % 5 * 2 - 4, 0.3, i // 5 * 2 - 4) end
    return gr.node{children = all}
end

local function picture(name, node, light)
    return {node = node, file = name .. (mask and '-mask.exr' or '.exr'), width = 320, height = 240, eye = {0, 6, 11},
            view = {0, -0.48, -1}, fov = 42, colour = 'linear', integrator = 'path', spp = 64, lights = {light},
            background = {0, 0, 0}}
end

local sun = gr.directional_light{direction = {-0.4, -1, -0.3}, colour = {0.9, 0.8, 0.7}}
local point = gr.light{position = {3, 7, 5}, colour = {1, 0.9, 0.8}, intensity = 60}
local spot = gr.spot_light{position = {1, 9, 2}, target = {0, 0, 0}, inner = 9, outer = 10, colour = {1, 1, 1}, intensity = 90} -- Blender multiplies by the cosine from the axis
gr.render(picture('sun', shapes(), sun))
gr.render(picture('point', shapes(), point))
gr.render(picture('spot', shapes(), spot))
gr.render(picture('solids', solids(), sun))
gr.render(picture('crowd', crowd(), point))
