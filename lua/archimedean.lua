-- archimedean: the thirteen Archimedean solids, prisms and antiprisms.
-- Idea: the corners are closed forms (all even or all permutations of a few coordinates with all signs, or only those
-- with an even number of plus signs); edges join those that are nearest to each other, and the faces are found by
-- following the edges around each corner. Source: H. S. M. Coxeter, M. S. Longuet-Higgins, J. C. P. Miller, "Uniform
-- Polyhedra", Phil. Trans. R. Soc. A 246, 1954; the snub solids' constants are the real roots of t^3 = t^2 + t + 1 and
-- x^3 = 2 x + phi. Invariant: corners on the unit sphere, edges of one length, faces counter-clockwise seen from
-- outside.
--
--   local archimedean = require 'archimedean'
--   local ball = gr.mesh(leather, archimedean.solid 'truncated icosahedron')
--   for _, name in ipairs(archimedean.names) do ... end

local check = require 'check'

local M = {}

local phi = (1 + math.sqrt(5)) / 2

-- The order of Kepler's list by number of corners.
M.names = {
    'truncated tetrahedron', 'cuboctahedron', 'truncated cube', 'truncated octahedron', 'rhombicuboctahedron',
    'truncated cuboctahedron', 'snub cube', 'icosidodecahedron', 'truncated dodecahedron', 'truncated icosahedron',
    'rhombicosidodecahedron', 'truncated icosidodecahedron', 'snub dodecahedron',
}

local even = { { 1, 2, 3 }, { 2, 3, 1 }, { 3, 1, 2 } }
local odd = { { 2, 1, 3 }, { 1, 3, 2 }, { 3, 2, 1 } }

--- Adds the permutations of a tuple with the signs that `keep` allows; duplicates are left out.
local function spread(out, tuple, orders, keep)
    for _, order in ipairs(orders) do
        for signs = 0, 7 do
            local p, minus = {}, 0
            for k = 1, 3 do
                local negative = signs >> (k - 1) & 1 == 1
                minus = minus + (negative and 1 or 0)
                p[k] = tuple[order[k]] * (negative and -1 or 1)
            end
            local fresh = not keep or keep(minus)
            for _, q in ipairs(out) do
                if math.abs(p[1] - q[1]) + math.abs(p[2] - q[2]) + math.abs(p[3] - q[3]) < 1e-9 then fresh = false end
            end
            if fresh then out[#out + 1] = p end
        end
    end
end

local function all(...)
    local out = {}
    for _, tuple in ipairs { ... } do
        spread(out, tuple, even)
        spread(out, tuple, odd)
    end
    return out
end

local function turned(...)
    local out = {}
    for _, tuple in ipairs { ... } do spread(out, tuple, even) end
    return out
end

local function is_even(minus) return minus % 2 == 0 end
local function is_odd(minus) return minus % 2 == 1 end

local corners = {
    ['truncated tetrahedron'] = function()
        local out = {}
        spread(out, { 3, 1, 1 }, even, is_even)
        return out
    end,
    cuboctahedron = function() return all { 1, 1, 0 } end,
    ['truncated cube'] = function() return all { math.sqrt(2) - 1, 1, 1 } end,
    ['truncated octahedron'] = function() return all { 0, 1, 2 } end,
    rhombicuboctahedron = function() return all { 1, 1, 1 + math.sqrt(2) } end,
    ['truncated cuboctahedron'] = function() return all { 1, 1 + math.sqrt(2), 1 + 2 * math.sqrt(2) } end,
    ['snub cube'] = function()
        local t, out = 1.839286755214161, {}
        spread(out, { 1, 1 / t, t }, even, is_odd)
        spread(out, { 1, 1 / t, t }, odd, is_even)
        return out
    end,
    icosidodecahedron = function() return turned({ 0, 0, phi }, { 1 / 2, phi / 2, phi * phi / 2 }) end,
    ['truncated dodecahedron'] = function()
        return turned({ 0, 1 / phi, 2 + phi }, { 1 / phi, phi, 2 * phi }, { phi, 2, phi + 1 })
    end,
    ['truncated icosahedron'] = function()
        return turned({ 0, 1, 3 * phi }, { 1, 2 + phi, 2 * phi }, { phi, 2, 2 * phi + 1 })
    end,
    rhombicosidodecahedron = function()
        return turned({ 1, 1, phi ^ 3 }, { phi * phi, phi, 2 * phi }, { 2 + phi, 0, phi * phi })
    end,
    ['truncated icosidodecahedron'] = function()
        return turned({ 1 / phi, 1 / phi, 3 + phi }, { 2 / phi, phi, 1 + 2 * phi }, { 1 / phi, phi * phi, 3 * phi - 1 },
            { 2 * phi - 1, 2, 2 + phi }, { phi, 3, 2 * phi })
    end,
    ['snub dodecahedron'] = function()
        local x = 1.715561499697367
        local a, b, out = x - 1 / x, x * phi + phi * phi + phi / x, {}
        for _, tuple in ipairs {
            { 2 * a, 2, 2 * b },
            { a + b / phi + phi, -a * phi + b + 1 / phi, a / phi + b * phi - 1 },
            { a + b / phi - phi, a * phi - b + 1 / phi, a / phi + b * phi + 1 },
            { -a / phi + b * phi + 1, -a + b / phi - phi, a * phi + b - 1 / phi },
            { -a / phi + b * phi - 1, a - b / phi - phi, a * phi + b + 1 / phi },
        } do spread(out, tuple, even, is_odd) end
        return out
    end,
}

local function sub(a, b) return { a[1] - b[1], a[2] - b[2], a[3] - b[3] } end
local function dot(a, b) return a[1] * b[1] + a[2] * b[2] + a[3] * b[3] end
local function cross(a, b)
    return { a[2] * b[3] - a[3] * b[2], a[3] * b[1] - a[1] * b[3], a[1] * b[2] - a[2] * b[1] }
end

--- Faces of a convex solid whose edges are all of the smallest distance between two corners, the centre at the origin.
local function faces_of(verts)
    local least = math.huge
    for i = 1, #verts do
        for j = i + 1, #verts do
            local d = sub(verts[i], verts[j])
            least = math.min(least, dot(d, d))
        end
    end
    -- neighbours of each corner, counter-clockwise seen from outside
    local near = {}
    for i, p in ipairs(verts) do
        local list, x, y = {}, nil, nil
        for j, q in ipairs(verts) do
            local d = sub(q, p)
            if i ~= j and dot(d, d) < least * 1.0001 then
                if not x then x, y = d, cross(p, d) end
                list[#list + 1] = { j, math.atan(dot(d, y) / math.sqrt(dot(p, p)), dot(d, x) - dot(d, p) * dot(x, p) / dot(p, p)) }
            end
        end
        table.sort(list, function(a, b) return a[2] < b[2] end)
        near[i] = {}
        for k, item in ipairs(list) do near[i][k] = item[1] end
    end
    -- a face lies on the left of each of its edges: at the end of an edge, the next one goes to the neighbour before
    -- the one it came from
    local faces, used = {}, {}
    for i = 1, #verts do
        for _, j in ipairs(near[i]) do
            if not used[i * 1000 + j] then
                local face, from, to = {}, i, j
                repeat
                    used[from * 1000 + to] = true
                    face[#face + 1] = from - 1
                    local list, at = near[to], 0
                    for k, other in ipairs(list) do
                        if other == from then at = k end
                    end
                    from, to = to, list[(at - 2) % #list + 1]
                until from == i and to == j
                faces[#faces + 1] = face
            end
        end
    end
    return faces
end

local function on_sphere(verts)
    for _, p in ipairs(verts) do
        local length = math.sqrt(dot(p, p))
        p[1], p[2], p[3] = p[1] / length, p[2] / length, p[3] / length
    end
    return verts
end

--- One of the thirteen, by its name in archimedean.names.
---@param name string
---@return number[][] verts
---@return integer[][] faces
function M.solid(name)
    check.text('archimedean.solid', 'name', name)
    if not corners[name] then
        check.fail('archimedean.solid', ("there is no solid '%s'; there are %s"):format(name:sub(1, 40), table.concat(M.names, ', ')))
    end
    local verts = on_sphere(corners[name]())
    return verts, faces_of(verts)
end

--- A prism over a regular polygon, its sides squares, about the y axis.
---@param n integer  corners of the polygon, at least 3
---@return number[][] verts
---@return integer[][] faces
function M.prism(n)
    check.whole('archimedean.prism', 'n', n, 3, 10000)
    local verts, bottom, top, faces = {}, {}, {}, {}
    local half = math.sin(math.pi / n) -- half an edge, of a polygon of radius 1
    for k = 0, n - 1 do
        local x, z = math.cos(2 * math.pi * k / n), -math.sin(2 * math.pi * k / n)
        verts[k + 1], verts[n + k + 1] = { x, -half, z }, { x, half, z }
        bottom[n - k], top[k + 1] = k, n + k
        local next_k = (k + 1) % n
        faces[k + 1] = { k, next_k, n + next_k, n + k }
    end
    faces[n + 1], faces[n + 2] = bottom, top
    return on_sphere(verts), faces
end

--- An antiprism: two regular polygons turned against each other, with equilateral triangles between.
---@param n integer  at least 3; 3 is the octahedron
---@return number[][] verts
---@return integer[][] faces
function M.antiprism(n)
    check.whole('archimedean.antiprism', 'n', n, 3, 10000)
    local verts, bottom, top, faces = {}, {}, {}, {}
    -- height from edge^2 = h^2 + (2 sin(pi / 2n))^2, edge = 2 sin(pi / n)
    local h = math.sqrt((2 * math.sin(math.pi / n)) ^ 2 - (2 * math.sin(math.pi / (2 * n))) ^ 2) / 2
    for k = 0, n - 1 do
        local a, b = 2 * math.pi * k / n, 2 * math.pi * (k + 0.5) / n
        verts[k + 1], verts[n + k + 1] = { math.cos(a), -h, -math.sin(a) }, { math.cos(b), h, -math.sin(b) }
        bottom[n - k], top[k + 1] = k, n + k
        local next_k = (k + 1) % n
        faces[#faces + 1] = { k, next_k, n + k }
        faces[#faces + 1] = { next_k, n + next_k, n + k }
    end
    faces[#faces + 1], faces[#faces + 2] = bottom, top
    return on_sphere(verts), faces
end

return M
