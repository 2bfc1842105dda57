-- conway: operators that make one polyhedron from another.
-- Source: J. H. Conway, H. Burgiel, C. Goodman-Strauss, "The Symmetries of Things", 2008, chapter 21; D. Hart's notation.
-- Invariant: a closed mesh with faces counter-clockwise from outside gives such a mesh again. New corners are means
-- of old ones: the faces of dual, kis and similar operators need not be exactly planar.
--
--   local conway, polyhedra = require 'conway', require 'polyhedra'
--   local ball = { conway.apply('tk', polyhedra.dodecahedron()) }      -- t of k of it, from right to left
--   local goldberg = { conway.dual(polyhedra.geodesic(2)) }

local check = require 'check'

local M = {}

local function edge_key(a, b) return a < b and a * 4294967296 + b or b * 4294967296 + a end

local function checked(name, verts, faces)
    check.points('conway.' .. name, 'verts', verts, 3)
    check.faces('conway.' .. name, 'faces', faces, #verts)
end

local function mean(verts, face)
    local x, y, z, n = 0, 0, 0, #face
    for _, index in ipairs(face) do
        local p = verts[index + 1]
        x, y, z = x + p[1], y + p[2], z + p[3]
    end
    return { x / n, y / n, z / n }
end

--- For every corner the faces around it, counter-clockwise: next_face[corner][face], and one to start from.
local function rounds(where, verts, faces)
    local owner = {} -- the face on the left of the edge from a to b
    for f, face in ipairs(faces) do
        for i, a in ipairs(face) do
            local b = face[i % #face + 1]
            local key = a * 4294967296 + b
            if owner[key] then check.fail('conway.' .. where, ('two faces lie on the left of the edge from %d to %d'):format(a, b)) end
            owner[key] = f
        end
    end
    local first = {}
    for f, face in ipairs(faces) do
        for i, a in ipairs(face) do
            if not first[a] then first[a] = { f, face[i % #face + 1] } end
        end
    end
    return function(corner)
        local begin = first[corner]
        if not begin then return nil end
        local list, to = {}, begin[2]
        repeat
            local f = owner[corner * 4294967296 + to]
            if not f then check.fail('conway.' .. where, ('the mesh is not closed at corner %d'):format(corner)) end
            list[#list + 1] = { f, to }
            -- the edge that comes into the corner in this face is the next one out, reversed
            local face = faces[f]
            for i, a in ipairs(face) do
                if a == corner then to = face[(i - 2) % #face + 1] end
            end
        until to == begin[2]
        return list
    end
end

--- A corner for each face and a face for each corner.
---@param verts number[][]
---@param faces integer[][]
---@return number[][] verts
---@return integer[][] faces
function M.dual(verts, faces)
    checked('dual', verts, faces)
    local out, new = {}, {}
    for f, face in ipairs(faces) do out[f] = mean(verts, face) end
    local round = rounds('dual', verts, faces)
    for corner = 0, #verts - 1 do
        local list = round(corner)
        if list then
            local face = {}
            for k, item in ipairs(list) do face[k] = item[1] - 1 end
            new[#new + 1] = face
        end
    end
    return out, new
end

--- A pyramid on every face (or on those with n corners).
---@param height number?  of the pyramids over their faces, in mean radii of the face; default 0
---@param n integer?  only on faces of so many corners
function M.kis(verts, faces, height, n)
    checked('kis', verts, faces)
    check.number('conway.kis', 'height', height, nil, nil, 0)
    local out, new = table.move(verts, 1, #verts, 1, {}), {}
    for _, face in ipairs(faces) do
        if n and #face ~= n then
            new[#new + 1] = face
        else
            local c, nx, ny, nz, radius = mean(verts, face), 0, 0, 0, 0
            for i, index in ipairs(face) do
                local p, q = verts[index + 1], verts[face[i % #face + 1] + 1]
                nx = nx + (p[2] - q[2]) * (p[3] + q[3])
                ny = ny + (p[3] - q[3]) * (p[1] + q[1])
                nz = nz + (p[1] - q[1]) * (p[2] + q[2])
                radius = radius + math.sqrt((p[1] - c[1]) ^ 2 + (p[2] - c[2]) ^ 2 + (p[3] - c[3]) ^ 2) / #face
            end
            local k = (height or 0) * radius / math.sqrt(nx * nx + ny * ny + nz * nz)
            out[#out + 1] = { c[1] + k * nx, c[2] + k * ny, c[3] + k * nz }
            for i, index in ipairs(face) do new[#new + 1] = { index, face[i % #face + 1], #out - 1 } end
        end
    end
    return out, new
end

--- Corners at a fraction of each edge from both its ends; at 1/2 the two coincide.
local function cut(where, verts, faces, share)
    local out, new, known = {}, {}, {}
    local function point(a, b)
        local key = share == 0.5 and edge_key(a, b) or a * 4294967296 + b
        if not known[key] then
            local p, q = verts[a + 1], verts[b + 1]
            out[#out + 1] = { p[1] + (q[1] - p[1]) * share, p[2] + (q[2] - p[2]) * share, p[3] + (q[3] - p[3]) * share }
            known[key] = #out - 1
        end
        return known[key]
    end
    for _, face in ipairs(faces) do
        local made = {}
        for i, a in ipairs(face) do
            local b = face[i % #face + 1]
            made[#made + 1] = point(a, b)
            if share ~= 0.5 then made[#made + 1] = point(b, a) end
        end
        new[#new + 1] = made
    end
    local round = rounds(where, verts, faces)
    for corner = 0, #verts - 1 do
        local list = round(corner)
        if list then
            local face = {}
            for k, item in ipairs(list) do face[k] = point(corner, item[2]) end
            new[#new + 1] = face
        end
    end
    return out, new
end

--- Corners at the middles of edges: a face in each face and one at each corner.
function M.ambo(verts, faces)
    checked('ambo', verts, faces)
    return cut('ambo', verts, faces, 0.5)
end

--- Corners cut off.
---@param share number?  of an edge that is cut at each end, below 0.5; default such that faces of as many corners as the
---  first become regular
function M.truncate(verts, faces, share)
    checked('truncate', verts, faces)
    share = check.number('conway.truncate', 'share', share, 0.001, 0.499, 1 / (2 + 2 * math.cos(math.pi / #faces[1])))
    return cut('truncate', verts, faces, share)
end

local steps = {
    d = M.dual, k = M.kis, a = M.ambo, t = M.truncate,
    j = function(v, f) return M.dual(M.ambo(v, f)) end,
    e = function(v, f) return M.ambo(M.ambo(v, f)) end,
    o = function(v, f) return M.dual(M.ambo(M.ambo(v, f))) end,
    b = function(v, f) return M.truncate(M.ambo(v, f)) end,
    m = function(v, f) return M.dual(M.truncate(M.ambo(v, f))) end,
}

--- Several operators, the rightmost first: d dual, k kis, a ambo, t truncate, j join, e expand, o ortho, b bevel, m meta.
---@param word string
function M.apply(word, verts, faces)
    check.text('conway.apply', 'word', word)
    for k = #word, 1, -1 do
        local step = steps[word:sub(k, k)]
        if not step then check.fail('conway.apply', ("there is no operator '%s'; there are d k a t j e o b m"):format(word:sub(k, k))) end
        verts, faces = step(verts, faces)
    end
    return verts, faces
end

--- Moves all corners to the same distance from the origin.
---@param radius number?  default 1
function M.on_sphere(verts, faces, radius)
    checked('on_sphere', verts, faces)
    local out = {}
    for k, p in ipairs(verts) do
        local f = (radius or 1) / math.sqrt(p[1] ^ 2 + p[2] ^ 2 + p[3] ^ 2)
        out[k] = { p[1] * f, p[2] * f, p[3] * f }
    end
    return out, faces
end

return M
