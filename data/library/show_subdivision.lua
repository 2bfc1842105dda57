-- TITLE: Library: subdivision surfaces
-- Control meshes and their limit surfaces: Catmull and Clark's rule on a cross of cubes, Loop's on a star, step by
-- step. Author: gray project

local studio = require 'studio'
local colour, meshes, polyhedra, conway = require 'colour', require 'meshes', require 'polyhedra', require 'conway'

local scene = gr.node 'subdivision'

-- Six cubes on the faces of a seventh, without the faces between them.
local function jack()
    local verts, faces = {}, {}
    local low, high = polyhedra.box({ -1, -1, -1 }, { 1, 1, 1 }), nil
    for _, d in ipairs { { 1, 0, 0 }, { -1, 0, 0 }, { 0, 1, 0 }, { 0, -1, 0 }, { 0, 0, 1 }, { 0, 0, -1 } } do
        local lowest, highest = {}, {}
        for k = 1, 3 do
            lowest[k] = d[k] > 0 and 0.5 or d[k] < 0 and -1.6 or -0.5
            highest[k] = d[k] > 0 and 1.6 or d[k] < 0 and -0.5 or 0.5
        end
        local v, f = polyhedra.box(lowest, highest)
        for _, face in ipairs(f) do
            local x, y, z = 0, 0, 0
            for _, index in ipairs(face) do
                x, y, z = x + v[index + 1][1] / 4, y + v[index + 1][2] / 4, z + v[index + 1][3] / 4
            end
            -- the inner face of each arm lies on the middle cube
            if math.abs(x * d[1] + y * d[2] + z * d[3] - 0.5) > 1e-9 then
                local moved = {}
                for k, index in ipairs(face) do
                    verts[#verts + 1] = v[index + 1]
                    moved[k] = #verts - 1
                end
                faces[#faces + 1] = moved
            end
        end
    end
    return meshes.weld(verts, faces)
end

--- The edges of a mesh as thin rods.
local function cage(verts, faces, material, thickness)
    local node, seen = gr.node 'cage', {}
    for _, face in ipairs(faces) do
        for i, a in ipairs(face) do
            local b = face[i % #face + 1]
            local key = math.min(a, b) * 100000 + math.max(a, b)
            if not seen[key] then
                seen[key] = true
                node:add_child(gr.cylinder { from = verts[a + 1], to = verts[b + 1], radius = thickness, material = material })
            end
        end
    end
    for _, p in ipairs(verts) do node:add_child(gr.sphere { centre = p, radius = thickness, material = material }) end
    return node
end

local function place(node, x, y, z, size, turn) studio.place(scene, node, x, y, z, turn, size) end

local ink = studio.matt { 0.12, 0.13, 0.16 }
local function show(method, verts, faces, z, hue, size, steps)
    local y = select(2, table.unpack((meshes.bounds(verts))))
    local shown = { [0] = { verts, faces } }
    for step = 1, steps do shown[step] = { method(shown[step - 1][1], shown[step - 1][2]) } end
    for column, step in ipairs { 0, 1, 2, steps } do
        local v, f = shown[step][1], shown[step][2]
        local material = studio.glaze(colour.hsv(hue + 14 * column, 0.62, 0.72))
        local body = gr.node 'body'
        body:add_child(step == steps and gr.vn_mesh(material, table.unpack(meshes.smooth(v, f))) or gr.mesh(material, v, f))
        if step < steps then body:add_child(cage(verts, faces, ink, 0.022)) end
        place(body, 3.5 * (column - 2.5), -y * size + 0.02, z, size, 28)
    end
end

local cross_verts, cross_faces = jack()
show(polyhedra.catmull_clark, cross_verts, cross_faces, -2.2, 190, 0.95, quick and 3 or 4)
local star_verts, star_faces = conway.kis(polyhedra.octahedron())
for k = 7, #star_verts do -- the tips of the pyramids, extended
    for d = 1, 3 do star_verts[k][d] = 2.6 * star_verts[k][d] end
end
show(polyhedra.loop, star_verts, star_faces, 2.6, 8, 1.0, quick and 3 or 4)

studio.render { node = scene, file = 'show_subdivision.png', eye = { 0, 8.5, 17.5 }, target = { 0, 0.9, 0.2 }, fov = 26, key = { 1, 16, 3 }, lamp = 7,
    floor = { 0.34, 0.36, 0.38 }, sky = { 0.20, 0.23, 0.28 } }
