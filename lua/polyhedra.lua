-- polyhedra: the five Platonic solids, subdivision surfaces, geodesic spheres, boxes.
-- Subdivision: C. Loop, "Smooth Subdivision Surfaces Based on Triangles" (Utah 1987); E. Catmull, J. Clark, "Recursively
-- generated B-spline surfaces on arbitrary topological meshes", CAD 10(6), 1978. Borders follow the cubic B-spline rule.
-- Invariant: faces are counter-clockwise from outside with indices from 0; shared vertices stay shared.
--
--   local polyhedra = require 'polyhedra'
--   scene:add_child(gr.mesh(jade, polyhedra.dodecahedron()))
--   local verts, faces = polyhedra.subdivide(polyhedra.catmull_clark, 3, polyhedra.cube())

local check = require 'check'
local meshes = require 'meshes'

local M = {}

local phi = (1 + math.sqrt(5)) / 2

local function on_sphere(verts)
    local out = {}
    for i, p in ipairs(verts) do out[i] = { meshes.unit(p[1], p[2], p[3]) } end
    return out
end

--- Regular tetrahedron, corners on the unit sphere.
---@return number[][] verts
---@return integer[][] faces
function M.tetrahedron()
    return on_sphere { { 1, 1, 1 }, { -1, -1, 1 }, { -1, 1, -1 }, { 1, -1, -1 } },
        { { 0, 2, 1 }, { 0, 1, 3 }, { 0, 3, 2 }, { 1, 2, 3 } }
end

--- Cube, corners on the unit sphere.
---@return number[][] verts
---@return integer[][] faces
function M.cube()
    return on_sphere { { -1, -1, -1 }, { 1, -1, -1 }, { 1, 1, -1 }, { -1, 1, -1 }, { -1, -1, 1 }, { 1, -1, 1 },
                       { 1, 1, 1 }, { -1, 1, 1 } },
        { { 4, 5, 6, 7 }, { 1, 0, 3, 2 }, { 5, 1, 2, 6 }, { 0, 4, 7, 3 }, { 7, 6, 2, 3 }, { 0, 1, 5, 4 } }
end

--- Regular octahedron, corners on the unit sphere.
---@return number[][] verts
---@return integer[][] faces
function M.octahedron()
    return { { 1, 0, 0 }, { -1, 0, 0 }, { 0, 1, 0 }, { 0, -1, 0 }, { 0, 0, 1 }, { 0, 0, -1 } },
        { { 0, 2, 4 }, { 2, 1, 4 }, { 1, 3, 4 }, { 3, 0, 4 }, { 2, 0, 5 }, { 1, 2, 5 }, { 3, 1, 5 }, { 0, 3, 5 } }
end

--- Regular icosahedron, corners on the unit sphere.
---@return number[][] verts
---@return integer[][] faces
function M.icosahedron()
    return on_sphere { { -1, phi, 0 }, { 1, phi, 0 }, { -1, -phi, 0 }, { 1, -phi, 0 }, { 0, -1, phi }, { 0, 1, phi },
                       { 0, -1, -phi }, { 0, 1, -phi }, { phi, 0, -1 }, { phi, 0, 1 }, { -phi, 0, -1 }, { -phi, 0, 1 } },
        { { 0, 11, 5 }, { 0, 5, 1 }, { 0, 1, 7 }, { 0, 7, 10 }, { 0, 10, 11 }, { 1, 5, 9 }, { 5, 11, 4 }, { 11, 10, 2 },
          { 10, 7, 6 }, { 7, 1, 8 }, { 3, 9, 4 }, { 3, 4, 2 }, { 3, 2, 6 }, { 3, 6, 8 }, { 3, 8, 9 }, { 4, 9, 5 },
          { 2, 4, 11 }, { 6, 2, 10 }, { 8, 6, 7 }, { 9, 8, 1 } }
end

--- Regular dodecahedron, corners on the unit sphere: the dual of the icosahedron.
---@return number[][] verts
---@return integer[][] faces
function M.dodecahedron()
    local corners, triangles = M.icosahedron()
    local verts, around = {}, {}
    for k, face in ipairs(triangles) do
        local a, b, c = corners[face[1] + 1], corners[face[2] + 1], corners[face[3] + 1]
        verts[k] = { meshes.unit(a[1] + b[1] + c[1], a[2] + b[2] + c[2], a[3] + b[3] + c[3]) }
        for i = 1, 3 do
            local here = around[face[i]] or {}
            around[face[i]] = here
            -- the next triangle around a corner begins with the last edge of this one
            here[face[i % 3 + 1]] = { face = k - 1, to = face[(i + 1) % 3 + 1] }
        end
    end
    local faces = {}
    for corner = 0, #corners - 1 do
        local start = math.huge
        for candidate in pairs(around[corner]) do start = math.min(start, candidate) end
        local face, at = {}, start
        repeat
            local step = around[corner][at]
            face[#face + 1], at = step.face, step.to
        until at == start
        faces[#faces + 1] = face
    end
    return verts, faces
end

--- A box from its lowest to its highest corner, six quads.
---@param low number[]
---@param high number[]
---@return number[][] verts
---@return integer[][] faces
function M.box(low, high)
    check.tuple('polyhedra.box', 'low', low, 3)
    check.tuple('polyhedra.box', 'high', high, 3)
    local a, b = low, high
    return { { a[1], a[2], a[3] }, { b[1], a[2], a[3] }, { b[1], b[2], a[3] }, { a[1], b[2], a[3] },
             { a[1], a[2], b[3] }, { b[1], a[2], b[3] }, { b[1], b[2], b[3] }, { a[1], b[2], b[3] } },
        { { 4, 5, 6, 7 }, { 1, 0, 3, 2 }, { 5, 1, 2, 6 }, { 0, 4, 7, 3 }, { 7, 6, 2, 3 }, { 0, 1, 5, 4 } }
end

--- Splits all faces into triangles: n-gons as fans.
---@param faces integer[][]
---@return integer[][]
function M.triangles(faces)
    local out = {}
    for _, face in ipairs(faces) do
        for i = 2, #face - 1 do out[#out + 1] = { face[1], face[i], face[i + 1] } end
    end
    return out
end

--- Edges of a mesh: for every pair of neighbours one record { a, b, faces..., }.
local function edges_of(verts, faces)
    local count, list, known = #verts, {}, {}
    for k, face in ipairs(faces) do
        for i, a in ipairs(face) do
            local b = face[i % #face + 1]
            local key = a < b and a * count + b or b * count + a
            local edge = known[key]
            if not edge then
                edge = { a = a, b = b, faces = {}, opposite = {} }
                known[key] = edge
                list[#list + 1] = edge
            end
            edge.faces[#edge.faces + 1] = k
            if #face == 3 then edge.opposite[#edge.opposite + 1] = face[(i + 1) % 3 + 1] end
        end
    end
    return list, function(a, b) return known[a < b and a * count + b or b * count + a] end
end

local function combine(out, ...)
    local x, y, z = 0, 0, 0
    local parts = { ... }
    for i = 1, #parts, 2 do
        local p, w = parts[i], parts[i + 1]
        x, y, z = x + p[1] * w, y + p[2] * w, z + p[3] * w
    end
    out[#out + 1] = { x, y, z }
end

--- One step of Loop subdivision; other faces are first split into fans of triangles.
---@param verts number[][]
---@param faces integer[][]
---@return number[][] verts
---@return integer[][] faces
function M.loop(verts, faces)
    check.points('polyhedra.loop', 'verts', verts, 3)
    faces = M.triangles(check.faces('polyhedra.loop', 'faces', faces, #verts))
    local edges, find = edges_of(verts, faces)
    local out, near, border = {}, {}, {}
    for _, edge in ipairs(edges) do
        for _, pair in ipairs { { edge.a, edge.b }, { edge.b, edge.a } } do
            local list = near[pair[1]] or {}
            near[pair[1]] = list
            list[#list + 1] = pair[2]
            if #edge.faces == 1 then
                border[pair[1]] = border[pair[1]] or {}
                table.insert(border[pair[1]], pair[2])
            end
        end
    end
    for index = 0, #verts - 1 do
        local p, list, rim = verts[index + 1], near[index] or {}, border[index]
        if rim and #rim == 2 then
            combine(out, p, 0.75, verts[rim[1] + 1], 0.125, verts[rim[2] + 1], 0.125)
        else
            local n = #list
            local beta = n == 0 and 0 or (5 / 8 - (3 / 8 + math.cos(2 * math.pi / n) / 4) ^ 2) / n
            local parts = { p, 1 - n * beta }
            for _, other in ipairs(list) do
                parts[#parts + 1] = verts[other + 1]
                parts[#parts + 1] = beta
            end
            combine(out, table.unpack(parts))
        end
    end
    for _, edge in ipairs(edges) do
        local a, b = verts[edge.a + 1], verts[edge.b + 1]
        if #edge.opposite == 2 then
            combine(out, a, 0.375, b, 0.375, verts[edge.opposite[1] + 1], 0.125, verts[edge.opposite[2] + 1], 0.125)
        else
            combine(out, a, 0.5, b, 0.5)
        end
        edge.point = #out - 1
    end
    local new = {}
    for _, face in ipairs(faces) do
        local a, b, c = face[1], face[2], face[3]
        local ab, bc, ca = find(a, b).point, find(b, c).point, find(c, a).point
        new[#new + 1] = { a, ab, ca }
        new[#new + 1] = { ab, b, bc }
        new[#new + 1] = { ca, bc, c }
        new[#new + 1] = { ab, bc, ca }
    end
    return out, new
end

--- One step of Catmull-Clark subdivision.
---@param verts number[][]
---@param faces integer[][]
---@return number[][] verts
---@return integer[][] faces
function M.catmull_clark(verts, faces)
    check.points('polyhedra.catmull_clark', 'verts', verts, 3)
    check.faces('polyhedra.catmull_clark', 'faces', faces, #verts)
    local edges, find = edges_of(verts, faces)
    local centres = {}
    for _, face in ipairs(faces) do
        local parts = {}
        for _, index in ipairs(face) do
            parts[#parts + 1] = verts[index + 1]
            parts[#parts + 1] = 1 / #face
        end
        combine(centres, table.unpack(parts))
    end
    local around_faces, around_edges, border = {}, {}, {}
    for k, face in ipairs(faces) do
        for _, index in ipairs(face) do
            around_faces[index] = around_faces[index] or {}
            table.insert(around_faces[index], k)
        end
    end
    for _, edge in ipairs(edges) do
        for _, index in ipairs { edge.a, edge.b } do
            around_edges[index] = around_edges[index] or {}
            table.insert(around_edges[index], edge)
            if #edge.faces == 1 then
                border[index] = border[index] or {}
                table.insert(border[index], index == edge.a and edge.b or edge.a)
            end
        end
    end
    local out = {}
    for index = 0, #verts - 1 do
        local p, rim, list = verts[index + 1], border[index], around_faces[index] or {}
        local n = #list
        if rim and #rim == 2 then
            combine(out, p, 0.75, verts[rim[1] + 1], 0.125, verts[rim[2] + 1], 0.125)
        elseif n == 0 then
            out[#out + 1] = p
        else
            local parts = { p, (n - 3) / n }
            for _, k in ipairs(list) do
                parts[#parts + 1] = centres[k]
                parts[#parts + 1] = 1 / (n * n)
            end
            for _, edge in ipairs(around_edges[index]) do
                parts[#parts + 1] = verts[edge.a + 1]
                parts[#parts + 1] = 1 / (n * n)
                parts[#parts + 1] = verts[edge.b + 1]
                parts[#parts + 1] = 1 / (n * n)
            end
            combine(out, table.unpack(parts))
        end
    end
    for _, edge in ipairs(edges) do
        local a, b = verts[edge.a + 1], verts[edge.b + 1]
        if #edge.faces == 2 then
            combine(out, a, 0.25, b, 0.25, centres[edge.faces[1]], 0.25, centres[edge.faces[2]], 0.25)
        else
            combine(out, a, 0.5, b, 0.5)
        end
        edge.point = #out - 1
    end
    local first = #out
    table.move(centres, 1, #centres, first + 1, out)
    local new = {}
    for k, face in ipairs(faces) do
        local n = #face
        for i = 1, n do
            local here, ahead, back = face[i], face[i % n + 1], face[(i - 2) % n + 1]
            new[#new + 1] = { here, find(here, ahead).point, first + k - 1, find(back, here).point }
        end
    end
    return out, new
end

--- Subdivides several times.
---@param method fun(verts: number[][], faces: integer[][]): number[][], integer[][]  polyhedra.loop or polyhedra.catmull_clark
---@param times integer
---@param verts number[][]
---@param faces integer[][]
---@return number[][] verts
---@return integer[][] faces
function M.subdivide(method, times, verts, faces)
    check.callable('polyhedra.subdivide', 'method', method)
    check.whole('polyhedra.subdivide', 'times', times, 0, 10)
    for _ = 1, times do verts, faces = method(verts, faces) end
    return verts, faces
end

--- Geodesic sphere of radius 1: an icosahedron whose triangles are divided into four and projected onto the sphere.
---@param times integer?  20 * 4^times triangles, default 3
---@return number[][] verts
---@return number[][] normals  the same points
---@return integer[][] faces
---@return integer[][] face_normals
function M.geodesic(times)
    times = check.whole('polyhedra.geodesic', 'times', times, 0, 8, 3)
    local verts, faces = M.icosahedron()
    for _ = 1, times do
        local _, find = edges_of(verts, faces)
        local out, new = table.move(verts, 1, #verts, 1, {}), {}
        local function middle(a, b)
            local edge = find(a, b)
            if not edge.point then
                local p, q = verts[a + 1], verts[b + 1]
                out[#out + 1] = { meshes.unit(p[1] + q[1], p[2] + q[2], p[3] + q[3]) }
                edge.point = #out - 1
            end
            return edge.point
        end
        for _, face in ipairs(faces) do
            local a, b, c = face[1], face[2], face[3]
            local ab, bc, ca = middle(a, b), middle(b, c), middle(c, a)
            new[#new + 1] = { a, ab, ca }
            new[#new + 1] = { ab, b, bc }
            new[#new + 1] = { ca, bc, c }
            new[#new + 1] = { ab, bc, ca }
        end
        verts, faces = out, new
    end
    return verts, verts, faces, faces
end

return M
