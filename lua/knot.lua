-- knot: torus knots, as curves and as tubes. The (p, q) knot winds p times around the axis and q times through the hole
-- (C. Adams, "The Knot Book", 5.1). Coprime p and q give one closed curve. Also Lissajous knots
-- (M. Bogle et al., "Lissajous Knots", J. Knot Theory 3(2), 1994) and some named knots. Tubes have rotation-minimising
-- frames (sweep.frames), so that they are not twisted.
--
--   local knot = require 'knot'
--   scene:add_child(gr.vn_mesh(gold, knot.mesh(2, 3)))
--   scene:add_child(gr.vn_mesh(red, knot.tube(knot.named 'figure eight', 0.25)))
--   scene:add_child(gr.sweep {points = knot.curve(3, 5, 60), radii = 0.1, loop = true, material = blue})   -- exact

local check = require 'check'
local sweep = require 'sweep'

local M = {}

--- Points of a torus knot around the y axis.
---@param p integer
---@param q integer
---@param n integer?  number of points, default 240
---@param big number?  radius of the torus, default 1
---@param small number?  radius of its ring, default 0.4
---@return number[][] points
function M.curve(p, q, n, big, small)
    check.whole('knot.curve', 'p', p)
    check.whole('knot.curve', 'q', q)
    n = check.whole('knot.curve', 'n', n, 3, 1000000, 240)
    big, small = check.above('knot.curve', 'big', big, 0, 1), check.above('knot.curve', 'small', small, 0, 0.4)
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
    options = check.options('knot.mesh', options, 'n around big small radius')
    check.whole('knot.mesh', 'p', p)
    check.whole('knot.mesh', 'q', q)
    local a, b = math.abs(p), math.abs(q)
    while b ~= 0 do a, b = b, a % b end
    if a ~= 1 then check.fail('knot.mesh', ('p and q must have no common divisor; %d and %d have %d'):format(p, q, a)) end
    local path = M.curve(p, q, options.n, options.big, options.small)
    return sweep.tube(path, options.radius or 0.15, options.around or 16, { closed = true })
end

--- Points of a Lissajous knot between -1 and 1: cosines of three frequencies with three phases.
---@param frequencies integer[]  three, without common divisors
---@param phases number[]  three, in parts of a turn
---@param n integer?  default 240
---@return number[][] points
function M.lissajous(frequencies, phases, n)
    check.tuple('knot.lissajous', 'frequencies', frequencies, 3)
    check.tuple('knot.lissajous', 'phases', phases, 3)
    n = check.whole('knot.lissajous', 'n', n, 3, 1000000, 240)
    local points = {}
    for i = 0, n - 1 do
        local p = {}
        for k = 1, 3 do p[k] = math.cos(2 * math.pi * (frequencies[k] * i / n + phases[k])) end
        points[i + 1] = p
    end
    return points
end

local function torus(p, q) return function(n) return M.curve(p, q, n, 1, 0.45) end end

-- Each with its number in the table of Alexander and Briggs.
local named = {
    trefoil = torus(2, 3), -- 3_1
    cinquefoil = torus(2, 5), -- 5_1
    septafoil = torus(2, 7), -- 7_1
    ['figure eight'] = function(n) -- 4_1
        local points = {}
        for i = 0, n - 1 do
            local t = 2 * math.pi * i / n
            points[i + 1] = { (2 + math.cos(2 * t)) * math.cos(3 * t) / 3, math.sin(4 * t) / 3, (2 + math.cos(2 * t)) * math.sin(3 * t) / 3 }
        end
        return points
    end,
    granny = function(n) -- 3_1 # 3_1
        local points = {}
        for i = 0, n - 1 do
            local t = 2 * math.pi * i / n
            points[i + 1] = { (-22 * math.cos(t) - 128 * math.sin(t) - 44 * math.cos(3 * t) - 78 * math.sin(3 * t)) / 200,
                              (70 * math.cos(3 * t) - 40 * math.sin(3 * t)) / 200,
                              (-10 * math.cos(2 * t) - 27 * math.sin(2 * t) + 38 * math.cos(4 * t) + 46 * math.sin(4 * t)) / 200 }
        end
        return points
    end,
    ['three twist'] = function(n) return M.lissajous({ 3, 2, 7 }, { 0.7 / (2 * math.pi), 0.2 / (2 * math.pi), 0 }, n) end, -- 5_2
}

--- Points of a knot by name: trefoil, figure eight, cinquefoil, three twist, septafoil, granny. Its size is about 1.
---@param name string
---@param n integer?  default 240
---@return number[][] points
function M.named(name, n)
    check.text('knot.named', 'name', name)
    if not named[name] then
        check.fail('knot.named', ("there is no knot '%s'; there are trefoil, figure eight, cinquefoil, three twist, septafoil, granny"):format(name:sub(1, 40)))
    end
    return named[name](check.whole('knot.named', 'n', n, 3, 1000000, 240))
end

--- A closed tube along points.
---@param points number[][]
---@param radius number?  default 0.15
---@param around integer?  default 16
---@return number[][] verts
---@return number[][] normals
---@return integer[][] faces
---@return integer[][] face_normals
function M.tube(points, radius, around)
    check.points('knot.tube', 'points', points, 3, 3)
    return sweep.tube(points, check.above('knot.tube', 'radius', radius, 0, 0.15), check.whole('knot.tube', 'around', around, 3, 1000, 16),
        { closed = true })
end

return M
