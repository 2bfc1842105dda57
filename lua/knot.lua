-- knot: torus knots, as curves and as tubes. The (p, q) knot winds p times round the axis and q times through the hole
-- (C. Adams, "The Knot Book", 5.1). p and q without a common divisor give one closed curve.

local sweep = require 'sweep'

local M = {}

--- Points of a torus knot round the y axis.
---@param p integer
---@param q integer
---@param n integer?  number of points, default 240
---@param big number?  radius of the torus, default 1
---@param small number?  radius of its ring, default 0.4
---@return number[][] points
function M.curve(p, q, n, big, small)
    n, big, small = n or 240, big or 1, small or 0.4
    local points = {}
    for i = 0, n - 1 do
        local t = 2 * math.pi * i / n
        local r = big + small * math.cos(q * t)
        points[i + 1] = { r * math.cos(p * t), small * math.sin(q * t), r * math.sin(p * t) }
    end
    return points
end

--- A torus knot as a closed tube.
---@param p integer
---@param q integer
---@param options table?  n, around, big, small, radius of the tube (0.15)
---@return number[][] verts
---@return number[][] normals
---@return integer[][] faces
---@return integer[][] face_normals
function M.mesh(p, q, options)
    options = options or {}
    local path = M.curve(p, q, options.n, options.big, options.small)
    return sweep.tube(path, options.radius or 0.15, options.around or 16, { closed = true })
end

return M
