-- What the demos of the library share: a seamless backdrop, soft light from above and the camera.
-- Author: gray project

local colour, meshes = require 'colour', require 'meshes'

local M = {}

--- A glazed material of a colour.
function M.glaze(c)
    return gr.openpbr_material { base_color = c, specular_roughness = 0.35, coat_weight = 0.6, coat_roughness = 0.08 }
end

--- A matt one.
function M.matt(c) return gr.openpbr_material { base_color = c, specular_roughness = 0.6, specular_weight = 0.3 } end

M.gold = gr.metal_material { metal = 'gold', roughness = 0.2 }
M.silver = gr.metal_material { metal = 'silver', roughness = 0.22 }
M.copper = gr.metal_material { metal = 'copper', roughness = 0.25 }

--- Puts a node into a scene: scaled by `size` (1), turned about y by `turn` degrees, then moved.
function M.place(scene, node, x, y, z, turn, size)
    local sized, turned, placed = gr.node 'sized', gr.node 'turned', gr.node 'placed'
    sized:scale(size or 1, size or 1, size or 1)
    sized:add_child(node)
    turned:rotate('y', turn)
    turned:add_child(sized)
    placed:translate(x, y, z)
    placed:add_child(turned)
    scene:add_child(placed)
end

--- A floor that bends up into a wall behind.
function M.backdrop(c, back)
    back = back or -9
    local radius, points = 5, {}
    for k = 0, 3 do points[#points + 1] = { 60 - k * (60 - back) / 3, 0 } end
    for k = 1, 24 do
        local a = math.pi / 2 * k / 24
        points[#points + 1] = { back - radius * math.sin(a), radius * (1 - math.cos(a)) }
    end
    points[#points + 1] = { back - radius, 60 }
    local sheet = meshes.net(#points - 1, 1, function(i, j) return 200 * j - 100, points[i + 1][2], points[i + 1][1] end)
    return gr.vn_mesh(M.matt(c), table.unpack(sheet))
end

--- Renders a scene in the studio. `options`: node, file, eye, target, fov; size {640, 360}; floor: its colour, back: z of the
--- wall; key: where the large lamp is, lamp: the length of its side, light: what it gives the middle of the picture; sky:
--- the light from everywhere else; exposure.
function M.render(options)
    local root = gr.node 'studio'
    root:add_child(options.node)
    root:add_child(M.backdrop(options.floor or { 0.46, 0.46, 0.48 }, options.back))
    local key, size, target = gr.vec(options.key or { -7, 13, 8 }), options.lamp or 4, gr.vec(options.target)
    local towards = (target - key):normalize()
    local across = towards:cross(gr.vec(0, 1, 0)):normalize() * size
    local up = across:cross(towards)
    local emission = gr.vec(options.light or { 1.25, 1.12, 0.94 }) * (math.pi * gr.length(target - key) ^ 2 / size ^ 2)
    local sky = options.sky or { 0.26, 0.29, 0.34 }
    local picture = options.size or { 640, 360 }
    gr.render {
        node = root, file = options.file, width = picture[1], height = picture[2], eye = options.eye, target = options.target,
        fov = options.fov or 30, background = sky, integrator = 'path', spp = options.spp or 6, denoise = true, tone = 'filmic',
        exposure = options.exposure or -0.25, max_depth = 5, clamp = 12,
        lights = { gr.area_light { corner = key - (across + up) / 2, v1 = across, v2 = up, emission = emission },
            gr.sky_light { sky = sky } },
    }
end

M.colour = colour
return M
