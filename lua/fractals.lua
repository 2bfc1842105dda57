-- fractals: the Menger sponge, Sierpinski's tetrahedron and pyramid, the sphere flake.
-- Idea: as nodes, a level has several instances of the level below, so that memory grows with the level and not with
-- the number of cubes, which is 20^level; meshes contain only the surface.
-- Sources: K. Menger 1926 (a cell is removed if at least two of its ternary digits are 1); W. Sierpinski 1915; E.
-- Haines, "A Proposal for Standard Graphics Environments", IEEE CG&A 7(11), 1987 (the sphere flake).
-- Invariant: nodes work with every transform order: no node has two transforms.
--
--   local fractals = require 'fractals'
--   scene:add_child(fractals.menger(3, stone))                      -- 8,000 cubes between -1 and 1
--   local verts, faces = fractals.menger_mesh(3)                    -- the same as one closed mesh
--   scene:add_child(fractals.sphere_flake(4, {gold, silver}))

local check = require 'check'

local M = {}

local function holder(name, transform, ...)
    local node = gr.node(name)
    node[transform](node, ...)
    return node
end

--- A level with a scaled instance of the level below at each position.
local function level_of(name, below, factor, places)
    local shrunk, level = holder(name, 'scale', factor, factor, factor), gr.node(name)
    shrunk:add_child(below)
    for _, p in ipairs(places) do
        local place = holder(name, 'translate', p[1], p[2], p[3])
        place:add_child(shrunk)
        level:add_child(place)
    end
    return level
end

--- Whether a cell of the sponge's 3^level cells a side is full; all counted from 0.
---@param level integer
---@return boolean
function M.menger_has(level, i, j, k)
    for _ = 1, level do
        local ones = (i % 3 == 1 and 1 or 0) + (j % 3 == 1 and 1 or 0) + (k % 3 == 1 and 1 or 0)
        if ones >= 2 then return false end
        i, j, k = i // 3, j // 3, k // 3
    end
    return true
end

--- The Menger sponge between -1 and 1, of 20^level cubes, by instances.
---@param level integer  0 to 6
---@param material gr.material
---@return gr.node
function M.menger(level, material)
    check.whole('fractals.menger', 'level', level, 0, 6)
    local node, places = gr.nh_box(material, { -1, -1, -1 }, 2), {}
    for i = 0, 2 do
        for j = 0, 2 do
            for k = 0, 2 do
                if M.menger_has(1, i, j, k) then places[#places + 1] = { (i - 1) * 2 / 3, (j - 1) * 2 / 3, (k - 1) * 2 / 3 } end
            end
        end
    end
    for _ = 1, level do node = level_of('menger', node, 1 / 3, places) end
    return node
end

--- The surface of the sponge between -1 and 1 as a closed mesh of squares.
---@param level integer  0 to 4
---@return number[][] verts
---@return integer[][] faces
function M.menger_mesh(level)
    check.whole('fractals.menger_mesh', 'level', level, 0, 4)
    local n = math.tointeger(3 ^ level)
    local verts, faces, known = {}, {}, {}
    local function vertex(i, j, k)
        local key = (i * (n + 1) + j) * (n + 1) + k
        if not known[key] then
            verts[#verts + 1] = { 2 * i / n - 1, 2 * j / n - 1, 2 * k / n - 1 }
            known[key] = #verts - 1
        end
        return known[key]
    end
    local function has(i, j, k)
        return i >= 0 and j >= 0 and k >= 0 and i < n and j < n and k < n and M.menger_has(level, i, j, k)
    end
    for i = 0, n - 1 do
        for j = 0, n - 1 do
            for k = 0, n - 1 do
                if M.menger_has(level, i, j, k) then
                    -- the square between this cell and the next along an axis, if that is empty
                    for axis = 0, 2 do
                        for side = 0, 1 do
                            local d = { 0, 0, 0 }
                            d[axis + 1] = 2 * side - 1
                            if not has(i + d[1], j + d[2], k + d[3]) then
                                local corner = { i, j, k }
                                corner[axis + 1] = corner[axis + 1] + side
                                local u, v = (axis + 1) % 3 + 1, (axis + 2) % 3 + 1
                                if side == 0 then u, v = v, u end
                                local face = {}
                                for s, step in ipairs { { 0, 0 }, { 1, 0 }, { 1, 1 }, { 0, 1 } } do
                                    local c = { corner[1], corner[2], corner[3] }
                                    c[u], c[v] = c[u] + step[1], c[v] + step[2]
                                    face[s] = vertex(c[1], c[2], c[3])
                                end
                                faces[#faces + 1] = face
                            end
                        end
                    end
                end
            end
        end
    end
    return verts, faces
end

local s3 = math.sqrt(3)
-- Corners of the two solids, edges of length 2, standing on y = 0 around the y axis; faces counter-clockwise from
-- outside.
local bodies = {
    tetrahedron = {
        corners = { { 0, 0, 2 / s3 }, { -1, 0, -1 / s3 }, { 1, 0, -1 / s3 }, { 0, 2 * math.sqrt(2 / 3), 0 } },
        faces = { { 0, 1, 2 }, { 0, 2, 3 }, { 2, 1, 3 }, { 1, 0, 3 } },
    },
    pyramid = {
        corners = { { -1, 0, 1 }, { 1, 0, 1 }, { 1, 0, -1 }, { -1, 0, -1 }, { 0, math.sqrt(2), 0 } },
        faces = { { 3, 2, 1, 0 }, { 0, 1, 4 }, { 1, 2, 4 }, { 2, 3, 4 }, { 3, 0, 4 } },
    },
}

--- Sierpinski's tetrahedron (4^level of them) or pyramid (5^level), by instances. Edges 2, on y = 0.
---@param level integer  0 to 10
---@param material gr.material
---@param kind? 'tetrahedron'|'pyramid'
---@return gr.node
function M.sierpinski(level, material, kind)
    check.whole('fractals.sierpinski', 'level', level, 0, 10)
    local body = bodies[check.word('fractals.sierpinski', 'kind', kind, 'tetrahedron pyramid', 'pyramid')]
    local node, places = gr.mesh(material, body.corners, body.faces), {}
    for k, p in ipairs(body.corners) do places[k] = { p[1] / 2, p[2] / 2, p[3] / 2 } end
    for _ = 1, level do node = level_of('sierpinski', node, 1 / 2, places) end
    return node
end

--- The same as one mesh of triangles and squares. Tetrahedra touch at points, pyramids also along edges, so that only
--- the former can be operands of CSG.
---@param level integer  0 to 8
---@param kind? 'tetrahedron'|'pyramid'
---@return number[][] verts
---@return integer[][] faces
function M.sierpinski_mesh(level, kind)
    check.whole('fractals.sierpinski_mesh', 'level', level, 0, 8)
    local body = bodies[check.word('fractals.sierpinski_mesh', 'kind', kind, 'tetrahedron pyramid', 'pyramid')]
    local verts, faces = {}, {}
    local function fill(depth, x, y, z, size)
        if depth > 0 then
            for _, p in ipairs(body.corners) do
                fill(depth - 1, x + p[1] * size / 2, y + p[2] * size / 2, z + p[3] * size / 2, size / 2)
            end
            return
        end
        local base = #verts
        for k, p in ipairs(body.corners) do verts[base + k] = { x + p[1] * size, y + p[2] * size, z + p[3] * size } end
        for _, face in ipairs(body.faces) do
            local moved = {}
            for k, index in ipairs(face) do moved[k] = index + base end
            faces[#faces + 1] = moved
        end
    end
    fill(level, 0, 0, 0, 1)
    return verts, faces
end

-- Positions of the nine balls on one whose axis is y: six around its equator, three above; degrees.
local seats = {}
for k = 0, 5 do seats[#seats + 1] = { 60 * k, 90 } end
for k = 0, 2 do seats[#seats + 1] = { 120 * k + 30, math.deg(math.acos(math.sqrt(2 / 3))) } end

--- A ball of radius 1 with nine balls of a third of its size on it, recursively: (9^(level + 1) - 1) / 8 balls.
---@param level integer  0 to 6
---@param materials gr.material|gr.material[]  one, or one for each size from the largest on; the last holds for the rest
---@return gr.node
function M.sphere_flake(level, materials)
    check.whole('fractals.sphere_flake', 'level', level, 0, 6)
    if type(materials) ~= 'table' then materials = { materials } end
    local node
    for depth = level, 0, -1 do
        local ball = gr.node 'ball'
        ball:add_child(gr.sphere(materials[math.min(depth + 1, #materials)]))
        if node then
            local out = holder('out', 'translate', 0, 4 / 3, 0)
            local small = holder('small', 'scale', 1 / 3, 1 / 3, 1 / 3)
            out:add_child(small)
            small:add_child(node)
            for _, seat in ipairs(seats) do
                local round, down = holder('round', 'rotate', 'y', seat[1]), holder('down', 'rotate', 'z', -seat[2])
                ball:add_child(round)
                round:add_child(down)
                down:add_child(out)
            end
        end
        node = ball
    end
    return node
end

return M
