-- bezier: bicubic Bezier patches as meshes with vertex normals.
-- Idea: the tensor product is evaluated point by point with Bernstein polynomials; the normal is the cross product of
-- the two derivatives. If a corner or an edge of the patch has collapsed to a point, a derivative vanishes; there the
-- normal is taken slightly inside the patch, where it exists (Farin, "Curves and Surfaces", 4th ed., 16.7).
-- Spline surfaces become Bezier patches exactly: a bicubic B-spline by the matrix of C. de Boor, "A Practical Guide to
-- Splines", 1978, a surface through points by Catmull and Rom, "A Class of Local Interpolating Splines", 1974.
-- Invariant: quads that collapse to triangles are written as triangles, empty ones are left out.
--
--   local bezier = require 'bezier'
--   local control, patches = bezier.through(rows_of_points)              -- or bezier.b_spline(rows, true, false)
--   scene:add_child(gr.vn_mesh(silk, bezier.mesh(control, patches, 12)))
--   scene:add_child(gr.patch {points = control, patches = patches, tolerance = 0.001, material = silk})

local check = require 'check'

local M = {}

--- Point of a cubic Bezier curve and its derivative.
---@param a number
---@param b number
---@param c number
---@param d number
---@param t number
---@return number value
---@return number derivative
function M.cubic(a, b, c, d, t)
    local s = 1 - t
    return a * s * s * s + 3 * b * s * s * t + 3 * c * s * t * t + d * t * t * t,
        3 * ((b - a) * s * s + 2 * (c - b) * s * t + (d - c) * t * t)
end

--- Points of a cubic Bezier curve in two or three dimensions.
---@param p number[][]  four control points
---@param n integer  number of pieces
---@return number[][] points  n + 1 of them
function M.curve(p, n)
    local points = {}
    for i = 0, n do
        local q = {}
        for k = 1, #p[1] do q[k] = (M.cubic(p[1][k], p[2][k], p[3][k], p[4][k], i / n)) end
        points[#points + 1] = q
    end
    return points
end

--- Point and the two derivatives of a patch.
---@param c number[][]  16 control points, row by row; u runs along a row, v from row to row
---@param u number
---@param v number
---@return number[] point
---@return number[] du
---@return number[] dv
function M.eval(c, u, v)
    local p, du, dv, cubic = {}, {}, {}, M.cubic
    local r1, r2, r3, r4, r5, r6, r7, r8 = c[1], c[2], c[3], c[4], c[5], c[6], c[7], c[8]
    local r9, r10, r11, r12, r13, r14, r15, r16 = c[9], c[10], c[11], c[12], c[13], c[14], c[15], c[16]
    for k = 1, 3 do
        local a, da = cubic(r1[k], r2[k], r3[k], r4[k], u)
        local b, db = cubic(r5[k], r6[k], r7[k], r8[k], u)
        local d, dd = cubic(r9[k], r10[k], r11[k], r12[k], u)
        local e, de = cubic(r13[k], r14[k], r15[k], r16[k], u)
        p[k], dv[k] = cubic(a, b, d, e, v)
        du[k] = cubic(da, db, dd, de, v)
    end
    return p, du, dv
end

local function cross(a, b)
    return a[2] * b[3] - a[3] * b[2], a[3] * b[1] - a[1] * b[3], a[1] * b[2] - a[2] * b[1]
end

-- The cross product of the derivatives as a unit vector; nil where one of them vanishes.
local function normal_of(du, dv)
    local x, y, z = cross(du, dv)
    local size = math.sqrt((du[1] ^ 2 + du[2] ^ 2 + du[3] ^ 2) * (dv[1] ^ 2 + dv[2] ^ 2 + dv[3] ^ 2))
    local length = math.sqrt(x * x + y * y + z * z)
    if length > 1e-9 * size and length > 0 then return { x / length, y / length, z / length } end
end

--- Unit normal of a patch, du x dv.
---@param c number[][]  16 control points
---@param u number
---@param v number
---@return number[] normal
function M.normal(c, u, v)
    local step = 0
    repeat
        local _, du, dv = M.eval(c, u + (0.5 - u) * step, v + (0.5 - v) * step)
        local normal = normal_of(du, dv)
        if normal then return normal end
        step = step == 0 and 1e-4 or step * 10
    until step > 1
    return { 0, 1, 0 }
end

--- Patches as one mesh with vertex normals.
---@param control number[][]  control points
---@param patches integer[][]  16 numbers of control points for each patch, 0-based
---@param n integer?  pieces along each side of a patch, default 8
---@param flip boolean?  true: normals are dv x du
---@return number[][] verts
---@return number[][] normals
---@return integer[][] faces
---@return integer[][] face_normals
function M.mesh(control, patches, n, flip)
    check.points('bezier.mesh', 'control', control, 3, 4)
    check.list('bezier.mesh', 'patches', patches, 1)
    for i, patch in ipairs(patches) do
        if type(patch) ~= 'table' or #patch ~= 16 then
            check.fail('bezier.mesh', ('patches[%d] must be a tuple of 16 indices'):format(i))
        end
    end
    check.faces('bezier.mesh', 'patches', patches, #control)
    n = check.whole('bezier.mesh', 'n', n, 1, 1000, 8)
    local verts, normals, faces = {}, {}, {}
    local function same(a, b)
        local p, q = verts[a + 1], verts[b + 1]
        return math.abs(p[1] - q[1]) + math.abs(p[2] - q[2]) + math.abs(p[3] - q[3]) < 1e-9
    end
    for _, patch in ipairs(patches) do
        local c = {}
        for k = 1, 16 do c[k] = control[patch[k] + 1] end
        local base = #verts
        for j = 0, n do
            for i = 0, n do
                local p, du, dv = M.eval(c, i / n, j / n)
                local normal = normal_of(du, dv) or M.normal(c, i / n, j / n)
                if flip then normal = { -normal[1], -normal[2], -normal[3] } end
                verts[#verts + 1], normals[#normals + 1] = p, normal
            end
        end
        for j = 0, n - 1 do
            for i = 0, n - 1 do
                local a = base + j * (n + 1) + i
                local corners = flip and { a, a + n + 1, a + n + 2, a + 1 } or { a, a + 1, a + n + 2, a + n + 1 }
                local face = {}
                for k = 1, 4 do
                    if not same(corners[k], corners[k % 4 + 1]) then face[#face + 1] = corners[k] end
                end
                if #face >= 3 then faces[#faces + 1] = face end
            end
        end
    end
    return verts, normals, faces, faces
end

-- Converts four points of a uniform spline to the four Bezier points of its piece between the second and the third.
local to_bezier = {
    ['b-spline'] = { { 1 / 6, 4 / 6, 1 / 6, 0 }, { 0, 4 / 6, 2 / 6, 0 }, { 0, 2 / 6, 4 / 6, 0 }, { 0, 1 / 6, 4 / 6, 1 / 6 } },
    ['catmull-rom'] = { { 0, 1, 0, 0 }, { -1 / 6, 1, 1 / 6, 0 }, { 0, 1 / 6, 1, -1 / 6 }, { 0, 0, 1, 0 } },
}

--- Patches of a spline surface over a net of points.
local function spline_patches(where, kind, net, closed_u, closed_v)
    check.list(where, 'net', net, 2)
    local columns, rows = #check.points(where, 'net[1]', net[1], 3, 2), #net
    for j, row in ipairs(net) do
        check.points(where, ('net[%d]'):format(j), row, 3, 2)
        if #row ~= columns then check.fail(where, ('net[%d] must have %d points as net[1] has'):format(j, columns)) end
    end
    check.flag(where, 'closed_u', closed_u)
    check.flag(where, 'closed_v', closed_v)
    local open = kind == 'b-spline' and 4 or 2
    if columns < (closed_u and 3 or open) or rows < (closed_v and 3 or open) then
        check.fail(where, ('net has %d x %d points, which are too few'):format(columns, rows))
    end
    local matrix, interpolates = to_bezier[kind], kind == 'catmull-rom'
    -- a point of the net; beyond the ends of an open interpolating net the last piece is extended linearly
    local function along(i, count, closed, get)
        if closed then return get((i - 1) % count + 1) end
        if i >= 1 and i <= count then return get(i) end
        local a, b = get(i < 1 and 1 or count), get(i < 1 and 2 or count - 1)
        return { 2 * a[1] - b[1], 2 * a[2] - b[2], 2 * a[3] - b[3] }
    end
    local function at(i, j)
        return along(j, rows, closed_v, function(row)
            return along(i, columns, closed_u, function(column) return net[row][column] end)
        end)
    end
    local first = interpolates and 1 or 2
    local function pieces(count, closed) return closed and count or interpolates and count - 1 or count - 3 end
    local control, patches = {}, {}
    for j = 0, pieces(rows, closed_v) - 1 do
        for i = 0, pieces(columns, closed_u) - 1 do
            local patch = {}
            for v = 1, 4 do
                for u = 1, 4 do
                    local p = { 0, 0, 0 }
                    for m = 1, 4 do
                        for k = 1, 4 do
                            local w = matrix[u][k] * matrix[v][m]
                            if w ~= 0 then
                                local q = at(first + i + k - 2, first + j + m - 2)
                                p[1], p[2], p[3] = p[1] + w * q[1], p[2] + w * q[2], p[3] + w * q[3]
                            end
                        end
                    end
                    control[#control + 1] = p
                    patch[#patch + 1] = #control - 1
                end
            end
            patches[#patches + 1] = patch
        end
    end
    return control, patches
end

--- A bicubic B-spline surface, smooth to the second derivative, near its net of points.
---@param net number[][][]  rows of equally many points; u runs along a row
---@param closed_u boolean?  rows go round
---@param closed_v boolean?  the last row is followed by the first
---@return number[][] control  16 points a patch
---@return integer[][] patches
function M.b_spline(net, closed_u, closed_v) return spline_patches('bezier.b_spline', 'b-spline', net, closed_u, closed_v) end

--- A surface through all points of a net, smooth to the first derivative.
---@param net number[][][]
---@param closed_u boolean?
---@param closed_v boolean?
---@return number[][] control
---@return integer[][] patches
function M.through(net, closed_u, closed_v) return spline_patches('bezier.through', 'catmull-rom', net, closed_u, closed_v) end

return M
