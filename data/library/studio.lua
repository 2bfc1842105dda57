-- What the demos of the library share: a seamless backdrop, soft light from above and the camera.
-- Author: gray project

local colour, meshes = require 'colour', require 'meshes'

local M = {}

--- A glazed material of a colour.
function M.glaze(c, shine)
    return gr.rr_material(c, { 0.45, 0.45, 0.45 }, 90, shine or 0.08, 0, 1.5)
end

--- A matt one.
function M.matt(c) return gr.material(c, { 0.06, 0.06, 0.06 }, 12) end

M.gold = gr.rr_material({ 0.42, 0.28, 0.07 }, { 0.95, 0.74, 0.36 }, 90, 0.55, 0, 1)
M.silver = gr.rr_material({ 0.30, 0.31, 0.33 }, { 0.85, 0.87, 0.90 }, 90, 0.55, 0, 1)
M.copper = gr.rr_material({ 0.40, 0.17, 0.09 }, { 0.90, 0.56, 0.42 }, 70, 0.45, 0, 1)

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

--- Renders a scene in the studio. `options`: node, file, eye, target, fov; size {960, 540}, floor: its colour, back: z of the
--- wall, key: where the large lamp is, lamp: its size, light: its colour; side, fill: place (the camera's) and colour of a
--- second one; lights: more of them; ambient.
function M.render(options)
    local root = gr.node 'studio'
    root:add_child(options.node)
    root:add_child(M.backdrop(options.floor or { 0.60, 0.60, 0.62 }, options.back))
    local key, size = options.key or { -7, 13, 8 }, options.lamp or 4
    local lights = {
        gr.area_light({ key[1] - size / 2, key[2], key[3] - size / 2 }, { size, 0, 0 }, { 0, 0.4 * size, size },
            options.light or { 0.86, 0.82, 0.74 }, { 1, 0, 0 }),
        gr.light(options.side or options.eye, options.fill or { 0.20, 0.23, 0.29 }, { 1, 0, 0 }),
    }
    for _, light in ipairs(options.lights or {}) do lights[#lights + 1] = light end
    local picture = options.size or { 960, 540 }
    gr.render {
        node = root, file = options.file, width = picture[1], height = picture[2], eye = options.eye, target = options.target,
        fov = options.fov or 30, ambient = options.ambient or { 0.26, 0.27, 0.30 }, lights = lights,
        background = { 0.62, 0.66, 0.72 },
    }
end

M.colour = colour
return M
