-- meshes: small tools on polygon meshes as plain Lua tables.
-- A mesh is { verts, normals, faces, face_normals } in this order, so that table.unpack(mesh) fits gr.vn_mesh:
-- verts and normals are 3-tuples, faces and face_normals tuples of 0-based indices. A flat mesh has no normals.
-- Invariant: nothing here changes its arguments; every function returns new tables (which may share inner tuples).

local check = require 'check'

local M = {}

local sqrt, abs, acos, cos, sin, rad = math.sqrt, math.abs, math.acos, math.cos, math.sin, math.rad

--- Unit vector; the zero vector becomes +y.
---@param x number
---@param y number
---@param z number
---@return number x
---@return number y
---@return number z
function M.unit(x, y, z)
    local length = sqrt(x * x + y * y + z * z)
    if length == 0 then return 0, 1, 0 end
    return x / length, y / length, z / length
end

--- Makes a mesh value from the four tables.
---@param verts number[][]
---@param normals number[][]?
---@param faces integer[][]
---@param face_normals integer[][]?
---@return table mesh
function M.new(verts, normals, faces, face_normals)
    return { verts, normals, faces, face_normals or faces }
end

--- The table for one number of polygons and their triangles.
---@param faces integer[][]
---@return integer polygons
---@return integer triangles
function M.count(faces)
    local triangles = 0
    for _, face in ipairs(faces) do triangles = triangles + #face - 2 end
    return #faces, triangles
end

--- Joins meshes into one. All must have normals, or none.
---@param list table[]  meshes
---@return table mesh
function M.merge(list)
    check.table('meshes.merge', 'list', list)
    local verts, normals, faces, face_normals = {}, {}, {}, {}
    local smooth = #list > 0 and list[1][2] ~= nil
    for _, mesh in ipairs(list) do
        local base, normal_base = #verts, #normals
        table.move(mesh[1], 1, #mesh[1], base + 1, verts)
        for _, face in ipairs(mesh[3]) do
            local moved = {}
            for i, index in ipairs(face) do moved[i] = index + base end
            faces[#faces + 1] = moved
        end
        if smooth then
            table.move(mesh[2], 1, #mesh[2], normal_base + 1, normals)
            for _, face in ipairs(mesh[4]) do
                local moved = {}
                for i, index in ipairs(face) do moved[i] = index + normal_base end
                face_normals[#face_normals + 1] = moved
            end
        end
    end
    if not smooth then return { verts, nil, faces, nil } end
    return { verts, normals, faces, face_normals }
end

--- Applies an affine map: rows of a 3 x 4 matrix. Normals are transformed by the inverse transpose (the cofactors);
--- a mirroring map also reverses the faces, so that the outside stays the same.
---@param mesh table
---@param m number[]  twelve numbers, row by row
---@return table mesh
function M.map(mesh, m)
    check.table('meshes.map', 'mesh', mesh)
    local a, b, c, d, e, f, g, h, i = m[1], m[2], m[3], m[5], m[6], m[7], m[9], m[10], m[11]
    local verts = {}
    for k, p in ipairs(mesh[1]) do
        local x, y, z = p[1], p[2], p[3]
        verts[k] = { a * x + b * y + c * z + m[4], d * x + e * y + f * z + m[8], g * x + h * y + i * z + m[12] }
    end
    local c11, c12, c13 = e * i - f * h, f * g - d * i, d * h - e * g
    local c21, c22, c23 = c * h - b * i, a * i - c * g, b * g - a * h
    local c31, c32, c33 = b * f - c * e, c * d - a * f, a * e - b * d
    local sign = a * c11 + b * c12 + c * c13 < 0 and -1 or 1
    local normals
    if mesh[2] then
        normals = {}
        for k, n in ipairs(mesh[2]) do
            local x, y, z = n[1] * sign, n[2] * sign, n[3] * sign
            normals[k] = { M.unit(c11 * x + c12 * y + c13 * z, c21 * x + c22 * y + c23 * z,
                                  c31 * x + c32 * y + c33 * z) }
        end
    end
    if sign > 0 then return { verts, normals, mesh[3], mesh[4] } end
    return { verts, normals, M.turn(mesh[3]), mesh[4] and M.turn(mesh[4]) }
end

--- Moves a mesh.
function M.translate(mesh, x, y, z) return M.map(mesh, { 1, 0, 0, x, 0, 1, 0, y, 0, 0, 1, z }) end

--- Scales a mesh about the origin.
function M.scale(mesh, x, y, z)
    check.table('meshes.scale', 'mesh', mesh)
    y, z = y or x, z or x
    return M.map(mesh, { x, 0, 0, 0, 0, y, 0, 0, 0, 0, z, 0 })
end

--- Turns a mesh about an axis of the frame.
---@param mesh table
---@param axis 'x'|'y'|'z'
---@param degrees number
---@return table mesh
function M.rotate(mesh, axis, degrees)
    check.table('meshes.rotate', 'mesh', mesh)
    local c, s = cos(rad(degrees)), sin(rad(degrees))
    if axis == 'x' then return M.map(mesh, { 1, 0, 0, 0, 0, c, -s, 0, 0, s, c, 0 }) end
    if axis == 'y' then return M.map(mesh, { c, 0, s, 0, 0, 1, 0, 0, -s, 0, c, 0 }) end
    return M.map(mesh, { c, -s, 0, 0, s, c, 0, 0, 0, 0, 1, 0 })
end

--- Faces with their corners in the opposite order.
---@param faces integer[][]
---@return integer[][]
function M.turn(faces)
    check.table('meshes.turn', 'faces', faces)
    local turned = {}
    for k, face in ipairs(faces) do
        local back, n = {}, #face
        for i = 1, n do back[i] = face[n + 1 - i] end
        turned[k] = back
    end
    return turned
end

--- Reverses all faces and normals of a mesh.
---@param mesh table
---@return table mesh
function M.flip(mesh)
    check.table('meshes.flip', 'mesh', mesh)
    local normals
    if mesh[2] then
        normals = {}
        for k, n in ipairs(mesh[2]) do normals[k] = { -n[1], -n[2], -n[3] } end
    end
    return { mesh[1], normals, M.turn(mesh[3]), mesh[4] and M.turn(mesh[4]) }
end

--- Joins vertices that lie in the same cell of a fine lattice, and drops faces that vanish.
---@param verts number[][]
---@param faces integer[][]
---@param size number?  edge of the cells, default 1e-6
---@return number[][] verts
---@return integer[][] faces
function M.weld(verts, faces, size)
    check.table('meshes.weld', 'verts', verts)
    check.table('meshes.weld', 'faces', faces)
    size = size or 1e-6
    local known, new_verts, number_of = {}, {}, {}
    for k, p in ipairs(verts) do
        local key = ('%d,%d,%d'):format((p[1] / size + 0.5) // 1, (p[2] / size + 0.5) // 1, (p[3] / size + 0.5) // 1)
        local index = known[key]
        if not index then
            new_verts[#new_verts + 1] = p
            index = #new_verts - 1
            known[key] = index
        end
        number_of[k - 1] = index
    end
    local new_faces = {}
    for _, face in ipairs(faces) do
        local kept = {}
        for _, index in ipairs(face) do
            local n = number_of[index]
            if n ~= kept[#kept] then kept[#kept + 1] = n end
        end
        if #kept > 1 and kept[1] == kept[#kept] then kept[#kept] = nil end
        if #kept >= 3 then new_faces[#new_faces + 1] = kept end
    end
    return new_verts, new_faces
end

--- Normal of a polygon by Newell's method; its length is twice the area.
---@param verts number[][]
---@param face integer[]
---@return number x
---@return number y
---@return number z
function M.face_normal(verts, face)
    local x, y, z = 0, 0, 0
    local p = verts[face[#face] + 1]
    local px, py, pz = p[1], p[2], p[3]
    for i = 1, #face do
        local q = verts[face[i] + 1]
        local qx, qy, qz = q[1], q[2], q[3]
        x = x + (py - qy) * (pz + qz)
        y = y + (pz - qz) * (px + qx)
        z = z + (px - qx) * (py + qy)
        px, py, pz = qx, qy, qz
    end
    return x, y, z
end

-- The angle of a face at each of its corners. An edge from its other end is its exact negative; one of
-- length 0 is +y from both.
local function angles_of(verts, face, angles)
    local count = #face
    local p, q = verts[face[count] + 1], verts[face[1] + 1]
    local ax, ay, az = M.unit(p[1] - q[1], p[2] - q[2], p[3] - q[3])
    for i = 1, count do
        local r = verts[face[i % count + 1] + 1]
        local bx, by, bz = r[1] - q[1], r[2] - q[2], r[3] - q[3]
        local length = sqrt(bx * bx + by * by + bz * bz)
        if length == 0 then
            angles[i] = acos(ay > 1 and 1 or ay < -1 and -1 or ay)
            ax, ay, az = 0, 1, 0
        else
            bx, by, bz = bx / length, by / length, bz / length
            local dot = ax * bx + ay * by + az * bz
            angles[i] = acos(dot > 1 and 1 or dot < -1 and -1 or dot)
            ax, ay, az = -bx, -by, -bz
        end
        q = r
    end
end

-- The unit normal of a face; nil if it has no area: Newell's sums are then no larger than the rounding of their terms,
-- and their direction means nothing.
local function direction_of(verts, face)
    local x, y, z = M.face_normal(verts, face)
    local length, p, terms = sqrt(x * x + y * y + z * z), verts[face[#face] + 1], 0
    for i = 1, #face do
        local q = verts[face[i] + 1]
        local ax, ay, az = abs(p[1]) + abs(q[1]), abs(p[2]) + abs(q[2]), abs(p[3]) + abs(q[3])
        terms = terms + abs(p[2] - q[2]) * az + abs(p[3] - q[3]) * ax + abs(p[1] - q[1]) * ay
        p = q
    end
    if length <= 1e-14 * terms then return nil end
    return x / length, y / length, z / length
end

-- Without a crease: sums at the vertices, face after face.
local function smooth_everywhere(verts, faces)
    local sx, sy, sz, angles, normals = {}, {}, {}, {}, {}
    for k = 1, #verts do sx[k], sy[k], sz[k] = 0, 0, 0 end
    for _, face in ipairs(faces) do
        local x, y, z = direction_of(verts, face)
        if x then
            angles_of(verts, face, angles)
            for i = 1, #face do
                local at, w = face[i] + 1, angles[i]
                sx[at], sy[at], sz[at] = sx[at] + x * w, sy[at] + y * w, sz[at] + z * w
            end
        end
    end
    for k = 1, #verts do normals[k] = { M.unit(sx[k], sy[k], sz[k]) } end
    return { verts, normals, faces, faces }
end

--- Vertex normals: the sum of the normals of the faces at a vertex, weighted by their angle there.
--- Faces that meet at more than the crease angle keep separate normals. Faces without area have no influence, and the
--- normals of their corners are those of all faces there.
---@param verts number[][]
---@param faces integer[][]
---@param crease number?  degrees; default: smooth everywhere
---@return table mesh
function M.smooth(verts, faces, crease)
    check.table('meshes.smooth', 'verts', verts)
    check.table('meshes.smooth', 'faces', faces)
    if not crease then return smooth_everywhere(verts, faces) end
    local flat, around, angles, normals = {}, {}, {}, {}
    for k, face in ipairs(faces) do
        local n = { direction_of(verts, face) }
        flat[k] = n[1] and n
        if n[1] then angles_of(verts, face, angles) end
        for i = 1, #face do
            local here = face[i]
            local list = around[here]
            if not list then
                list = {}
                around[here] = list
            end
            if n[1] then list[#list + 1] = { n, angles[i] } end
        end
    end
    local limit, face_normals = cos(rad(crease)), {}
    for k, face in ipairs(faces) do
        local own, list = flat[k], {}
        for i, index in ipairs(face) do
            local x, y, z = 0, 0, 0
            for _, item in ipairs(around[index]) do
                local n, w = item[1], item[2]
                if not own or n[1] * own[1] + n[2] * own[2] + n[3] * own[3] >= limit then
                    x, y, z = x + n[1] * w, y + n[2] * w, z + n[3] * w
                end
            end
            normals[#normals + 1] = { M.unit(x, y, z) }
            list[i] = #normals - 1
        end
        face_normals[k] = list
    end
    return { verts, normals, faces, face_normals }
end

--- A rectangular net of points as quads, with vertex normals from the net itself.
--- The faces are oriented so that the normal is (step in j) x (step in i).
---@param ni integer  cells along i
---@param nj integer  cells along j
---@param point fun(i: integer, j: integer): number, number, number  i in 0..ni, j in 0..nj
---@param closed_i boolean?  the last row is the first
---@param closed_j boolean?  the last column is the first
---@return table mesh
function M.net(ni, nj, point, closed_i, closed_j)
    local rows, columns = closed_i and ni or ni + 1, closed_j and nj or nj + 1
    local verts, faces = {}, {}
    for i = 0, rows - 1 do
        for j = 0, columns - 1 do verts[#verts + 1] = { point(i, j) } end
    end
    for i = 0, ni - 1 do
        local here, above = i * columns, (i + 1) % rows * columns
        for j = 0, nj - 1 do
            local next_j = (j + 1) % columns
            faces[#faces + 1] = { here + j, here + next_j, above + next_j, above + j }
        end
    end
    return M.smooth(verts, faces)
end

--- Lowest and highest corner of the points.
---@param verts number[][]
---@return number[] low
---@return number[] high
function M.bounds(verts)
    check.table('meshes.bounds', 'verts', verts)
    local low, high = { math.huge, math.huge, math.huge }, { -math.huge, -math.huge, -math.huge }
    for _, p in ipairs(verts) do
        for k = 1, 3 do
            if p[k] < low[k] then low[k] = p[k] end
            if p[k] > high[k] then high[k] = p[k] end
        end
    end
    return low, high
end

--- The mesh as the text of an OBJ file.
---@param mesh table
---@param title string?  first comment line
---@return string
function M.to_obj(mesh, title)
    check.table('meshes.to_obj', 'mesh', mesh)
    local out = {}
    if title then out[1] = '# ' .. title end
    for _, p in ipairs(mesh[1]) do out[#out + 1] = ('v %.6g %.6g %.6g'):format(p[1], p[2], p[3]) end
    if mesh[2] then
        for _, n in ipairs(mesh[2]) do out[#out + 1] = ('vn %.4g %.4g %.4g'):format(n[1], n[2], n[3]) end
    end
    for k, face in ipairs(mesh[3]) do
        local words = { 'f' }
        for i, index in ipairs(face) do
            words[i + 1] = mesh[2] and ('%d//%d'):format(index + 1, mesh[4][k][i] + 1) or tostring(index + 1)
        end
        out[#out + 1] = table.concat(words, ' ')
    end
    return table.concat(out, '\n') .. '\n'
end

--- Counts of vertices that faces use, of edges and of faces. V - E + F is Euler's characteristic: 2 for every surface
--- equivalent to a sphere, 0 for a torus.
---@param faces integer[][]
---@return integer vertices
---@return integer edges
---@return integer faces
function M.euler(faces)
    check.table('meshes.euler', 'faces', faces)
    check.list('meshes.euler', 'faces', faces, 0)
    local seen, edges, vertex_count, edge_count = {}, {}, 0, 0
    for _, face in ipairs(faces) do
        for i, a in ipairs(face) do
            local b = face[i % #face + 1]
            if not seen[a] then seen[a], vertex_count = true, vertex_count + 1 end
            local low, high = a < b and a or b, a < b and b or a
            local key = low * 4294967296 + high
            if not edges[key] then edges[key], edge_count = true, edge_count + 1 end
        end
    end
    return vertex_count, edge_count, #faces
end

--- Whether every edge is used by exactly two faces, once in each direction: as gr.difference and similar functions
--- require of a mesh (they also join corners at the same position).
---@param faces integer[][]
---@return boolean
function M.is_closed(faces)
    check.table('meshes.is_closed', 'faces', faces)
    check.list('meshes.is_closed', 'faces', faces, 0)
    local used, open = {}, 0
    for _, face in ipairs(faces) do
        for i, a in ipairs(face) do
            local b = face[i % #face + 1]
            local key, back = a * 4294967296 + b, b * 4294967296 + a
            if used[key] then return false end
            used[key] = true
            open = open + (used[back] and -1 or 1)
        end
    end
    return open == 0
end

--- Volume of a closed mesh (the divergence theorem); positive if its faces are counter-clockwise from outside.
---@param verts number[][]
---@param faces integer[][]
---@return number
function M.volume(verts, faces)
    check.table('meshes.volume', 'verts', verts)
    check.table('meshes.volume', 'faces', faces)
    check.points('meshes.volume', 'verts', verts, 3)
    check.faces('meshes.volume', 'faces', faces, #verts)
    local six, o = 0, verts[1]
    for _, face in ipairs(faces) do
        local p = verts[face[1] + 1]
        local px, py, pz = p[1] - o[1], p[2] - o[2], p[3] - o[3]
        for i = 2, #face - 1 do
            local q, r = verts[face[i] + 1], verts[face[i + 1] + 1]
            local qx, qy, qz, rx, ry, rz = q[1] - o[1], q[2] - o[2], q[3] - o[3], r[1] - o[1], r[2] - o[2], r[3] - o[3]
            six = six + px * (qy * rz - qz * ry) + py * (qz * rx - qx * rz) + pz * (qx * ry - qy * rx)
        end
    end
    return six / 6
end

--- Total area of the faces; a non-planar face counts as a fan of triangles.
---@param verts number[][]
---@param faces integer[][]
---@return number
function M.area(verts, faces)
    check.table('meshes.area', 'verts', verts)
    check.table('meshes.area', 'faces', faces)
    check.points('meshes.area', 'verts', verts, 3)
    check.faces('meshes.area', 'faces', faces, #verts)
    local twice = 0
    for _, face in ipairs(faces) do
        local p = verts[face[1] + 1]
        local nx, ny, nz = 0, 0, 0
        for i = 2, #face - 1 do
            local q, r = verts[face[i] + 1], verts[face[i + 1] + 1]
            local ax, ay, az, bx, by, bz = q[1] - p[1], q[2] - p[2], q[3] - p[3], r[1] - p[1], r[2] - p[2], r[3] - p[3]
            nx, ny, nz = nx + ay * bz - az * by, ny + az * bx - ax * bz, nz + ax * by - ay * bx
        end
        twice = twice + sqrt(nx * nx + ny * ny + nz * nz)
    end
    return twice / 2
end

return M
