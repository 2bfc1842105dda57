-- bezier: bicubic Bezier patches as meshes with vertex normals.
-- Idea: the tensor product is evaluated point by point with Bernstein polynomials; the normal is the cross product of
-- the two derivatives. Where a corner or an edge of the patch has shrunk to a point a derivative vanishes; there the
-- normal is taken a little way inside the patch, where it exists (Farin, "Curves and Surfaces", 4th ed., 16.7).
-- Invariant: quads that shrink to triangles are written as triangles, those that vanish are not written at all.

local meshes = require 'meshes'

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
    local p, du, dv = {}, {}, {}
    for k = 1, 3 do
        local a, da = M.cubic(c[1][k], c[2][k], c[3][k], c[4][k], u)
        local b, db = M.cubic(c[5][k], c[6][k], c[7][k], c[8][k], u)
        local d, dd = M.cubic(c[9][k], c[10][k], c[11][k], c[12][k], u)
        local e, de = M.cubic(c[13][k], c[14][k], c[15][k], c[16][k], u)
        p[k], dv[k] = M.cubic(a, b, d, e, v)
        du[k] = M.cubic(da, db, dd, de, v)
    end
    return p, du, dv
end

local function cross(a, b)
    return a[2] * b[3] - a[3] * b[2], a[3] * b[1] - a[1] * b[3], a[1] * b[2] - a[2] * b[1]
end

--- Unit normal of a patch, du x dv.
---@param c number[][]  16 control points
---@param u number
---@param v number
---@return number[] normal
function M.normal(c, u, v)
    local step = 0
    repeat
        local inside_u, inside_v = u + (0.5 - u) * step, v + (0.5 - v) * step
        local _, du, dv = M.eval(c, inside_u, inside_v)
        local x, y, z = cross(du, dv)
        local size = math.sqrt((du[1] ^ 2 + du[2] ^ 2 + du[3] ^ 2) * (dv[1] ^ 2 + dv[2] ^ 2 + dv[3] ^ 2))
        local length = math.sqrt(x * x + y * y + z * z)
        if length > 1e-9 * size and length > 0 then return { x / length, y / length, z / length } end
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
    n = n or 8
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
                local p = M.eval(c, i / n, j / n)
                local normal = M.normal(c, i / n, j / n)
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

return M
