-- patterns: solid patterns as ordinary Lua functions of a point, for materials and as examples. Inside a recorded function
-- (docs/functions.md) they are as fast as the built-in patterns; called with numbers they give the same bits.
-- Sources: K. Perlin, "An Image Synthesizer", SIGGRAPH 1985 (marble, turbulence); S. Worley, "A Cellular Texture Basis
-- Function", SIGGRAPH 1996 (cells, spots); D. Ebert et al., "Texturing and Modeling", 3rd edition 2003 (wood, granite);
-- the chapter "Patterns" of POV-Ray's manual (the names, agate, leopard).
-- Invariants: a pattern is a number in 0..1 with a period or a typical feature size of about 1; scale the point for another
-- size. No lattice is visible: sums of noise rotate and shift every octave, because noise is 0 at all whole numbers.
-- Discontinuities of patterns are not in planes of whole numbers, because faces of boxes often are.
--
--   local patterns = require 'patterns'
--   local stone = gr.material{kd = function(p) return patterns.map('marble', patterns.marble(p)) end}
--   local wall = gr.material{kd = function(p)
--       local inside, id = patterns.bricks(p)
--       return gr.mix(gr.vec(0.6), gr.vec(0.5 + 0.3 * id, 0.15, 0.1), inside)
--   end}

local check = require 'check'

local M = {}

local floor, sin, cos, sqrt, abs, tau = math.floor, math.sin, math.cos, math.sqrt, math.abs, 2 * math.pi

-- Discontinuities are at k - OFFSET instead of k, so that a face at a whole number is on one side of them, in spite of
-- rounding.
local OFFSET <const> = 1 / 1024

--- x - floor(x).
local function fraction(x) return x - floor(x) end

--- 0 to 1 and back over a period of 1, as a cosine.
local function wave(x) return 0.5 - 0.5 * cos(tau * x) end

--- A rotation about an axis that is no diagonal of the lattice, and a shift.
local function turn(p)
    return gr.vec(0.8 * p.y + 0.6 * p.z + 0.37, 0.36 * p.y - 0.8 * p.x - 0.48 * p.z + 0.71, 0.64 * p.z - 0.6 * p.x - 0.48 * p.y + 0.13)
end

local function octaves_of(where, octaves, default) return check.whole('patterns.' .. where, 'octaves', octaves, 1, 16, default) end

--- Squares, or cubes in space: 0 or 1.
---@param p number[]
---@return number
function M.checker(p)
    local x, y, z = floor(p[1] + OFFSET), floor(p[2] + OFFSET), floor(p[3] + OFFSET)
    return (x + y + z) % 2 + 0.0
end

--- A ramp from 0 to 1 along a direction, repeated after its length.
---@param p number[]
---@param direction number[]?  default {0, 1, 0}
---@return number
function M.gradient(p, direction)
    direction = check.tuple('patterns.gradient', 'direction', direction, 3, { 0, 1, 0 })
    local square = direction[1] ^ 2 + direction[2] ^ 2 + direction[3] ^ 2
    if square == 0 then check.fail('patterns.gradient', 'direction must not be {0, 0, 0}') end
    return fraction(gr.dot(p, direction) / square + OFFSET)
end

--- Bricks in courses along x; the courses are stacked along y, and every second one is shifted by half a brick.
--- `options`: size {1, 0.35, 0.5} of a brick with its joint, joint 0.04: its width, bevel 0: the width of a soft edge.
---@param p number[]
---@param options table?
---@return number inside  1 in a brick, 0 in the joints
---@return number id  of the brick, a random number in 0..1
function M.bricks(p, options)
    options = check.options('patterns.bricks', options, 'size joint bevel')
    local size = check.tuple('patterns.bricks', 'size', options.size, 3, { 1, 0.35, 0.5 })
    local joint = check.number('patterns.bricks', 'joint', options.joint, 0, nil, 0.04)
    local bevel = check.number('patterns.bricks', 'bevel', options.bevel, 0, nil, 0)
    for k = 1, 3 do check.above('patterns.bricks', ('size[%d]'):format(k), size[k], 0) end
    local y = p[2] / size[2] + OFFSET
    local course = floor(y)
    local shift = 0.5 * (course % 2)
    local x, z = p[1] / size[1] + shift + OFFSET, p[3] / size[3] + shift + OFFSET
    -- The distance from the nearest joint's middle, in units of length.
    local function from_joint(t, length) return (0.5 - abs(fraction(t) - 0.5)) * length end
    local distance = gr.min(from_joint(x, size[1]), from_joint(y, size[2]), from_joint(z, size[3]))
    local id = gr.hash(floor(x), course, floor(z))
    if bevel > 0 then return gr.smoothstep(joint / 2, joint / 2 + bevel, distance), id end
    return gr.step(joint / 2, distance), id
end

--- A honeycomb in x and z with edges of length 1/2, in three kinds: hexagons of the same kind never touch.
---@param p number[]
---@return number kind  0, 1 or 2
---@return number inside  the distance from the next edge
function M.hexagons(p)
    -- Cube coordinates of the hexagons' centres, which are sqrt(3) / 2 apart (A. Patel, "Hexagonal Grids", 2013).
    local a = p[1] / 0.75 + OFFSET
    local b = p[3] / (sqrt(3) / 2) - a / 2
    local c = -a - b
    local i, j, k = floor(a + 0.5), floor(b + 0.5), floor(c + 0.5)
    local da, db, dc = abs(i - a), abs(j - b), abs(k - c)
    -- The coordinate with the largest rounding error is computed from the other two.
    local of_a = gr.min(gr.where(da - db, 1, 0), gr.where(da - dc, 1, 0))
    local of_b = gr.min(1 - of_a, gr.where(db - dc, 1, 0))
    local q = gr.where(of_a, -j - k, i)
    local r = gr.where(of_b, -i - k, j)
    local x, z = 0.75 * (a - q), sqrt(3) / 2 * ((b - r) + (a - q) / 2)
    local edge = sqrt(3) / 4 - gr.max(abs(z), abs(0.75 ^ 0.5 * x + 0.5 * z), abs(0.75 ^ 0.5 * x - 0.5 * z))
    return (q - r) % 3 + 0.0, edge
end

--- Round spots around random points: 1 inside, 0 outside.
---@param p number[]
---@param radius number?  default 0.3
---@param softness number?  share of the radius over which they fade; default 0.2
function M.spots(p, radius, softness)
    radius = check.above('patterns.spots', 'radius', radius, 0, 0.3)
    softness = check.number('patterns.spots', 'softness', softness, 1e-6, 1, 0.2)
    return 1 - gr.smoothstep(radius * (1 - softness), radius, (gr.cells(p)))
end

--- The sum of octaves of noise, as clouds; 0.5 on average.
---@param p number[]
---@param octaves integer?  default 5
function M.clouds(p, octaves)
    local sum, weight = 0, 1
    p = gr.vec(p)
    for _ = 1, octaves_of('clouds', octaves, 5) do
        p = turn(p)
        sum = sum + weight * gr.noise(p)
        p, weight = p * 2, weight / 2
    end
    return gr.clamp(0.5 + 0.6 * sum, 0, 1)
end

--- The sum of octaves of the absolute value of noise, with creases as in smoke and in the veins of marble; about 0..1.
---@param p number[]
---@param octaves integer?  default 5
function M.turbulence(p, octaves)
    local sum, weight = 0, 1
    p = gr.vec(p)
    for _ = 1, octaves_of('turbulence', octaves, 5) do
        p = turn(p)
        sum = sum + weight * abs(gr.noise(p))
        p, weight = p * 2, weight / 2
    end
    return sum
end

--- Cells around random points, as cobbles or scales.
---@param p number[]
---@return number id  of the cell, a random number in 0..1
---@return number inside  0 at the border to the next cell, up to about 1
function M.cells(p)
    local nearest, second, id = gr.cells(p)
    return id, second - nearest
end

--- Layers across x, bent by turbulence.
---@param p number[]
---@param amount number?  of turbulence, default 1
---@param octaves integer?  default 6
function M.marble(p, amount, octaves)
    amount = check.number('patterns.marble', 'amount', amount, nil, nil, 1)
    return wave(p[1] + amount * M.turbulence(p, octaves_of('marble', octaves, 6)))
end

--- Year rings around the z axis, which widen slowly and end sharply, and fibres along it.
---@param p number[]
---@param rings number?  in a unit of length, default 4
---@param wobble number?  of the rings, default 0.1
function M.wood(p, rings, wobble)
    rings = check.above('patterns.wood', 'rings', rings, 0, 4)
    wobble = check.number('patterns.wood', 'wobble', wobble, nil, nil, 0.1)
    local x, y, z = p[1], p[2], p[3]
    local bend = gr.vec(0.7 * x + 0.31, 0.7 * y + 0.57, 0.25 * z + 0.77)
    x = x + wobble * gr.noise(bend)
    y = y + wobble * gr.noise(bend + gr.vec(17.3, 5.1, 9.7))
    local ring = fraction(rings * sqrt(x * x + y * y) + 0.2 * gr.noise(2.1 * x + 0.4, 2.1 * y + 0.6, 0.4 * z + 0.3))
    local fibre = gr.noise(40 * x + 0.5, 40 * y + 0.5, 1.5 * z + 0.5)
    return gr.clamp(gr.smoothstep(0, 0.85, ring) * (1 - gr.smoothstep(0.85, 1, ring)) + 0.12 * fibre, 0, 1)
end

--- Bands of agate: layers across z in strong turbulence.
---@param p number[]
---@param amount number?  of turbulence, default 1
function M.agate(p, amount)
    amount = check.number('patterns.agate', 'amount', amount, nil, nil, 1)
    return (0.5 + 0.5 * sin(tau * (1.3 * amount * M.turbulence(p, 6) + 1.1 * p[3]))) ^ 0.77
end

--- Grains of granite.
---@param p number[]
function M.granite(p) return gr.clamp(1.2 * M.turbulence(gr.vec(p) * 4, 6), 0, 1) end

--- Soft spots in rows, as in POV-Ray's pattern of this name.
---@param p number[]
function M.leopard(p) return ((sin(tau * p[1]) + sin(tau * p[2]) + sin(tau * p[3])) / 3) ^ 2 end

--- Rings around the y axis, 0 in the middle.
---@param p number[]
function M.rings(p) return wave(sqrt(p[1] * p[1] + p[3] * p[3])) end

--- Ready maps for `patterns.map`.
M.maps = {
    marble = { { 0, { 0.10, 0.10, 0.14 } }, { 0.15, { 0.45, 0.45, 0.48 } }, { 0.4, { 0.85, 0.84, 0.82 } }, { 1, { 0.95, 0.94, 0.91 } } },
    pine = { { 0, { 0.86, 0.64, 0.36 } }, { 0.6, { 0.72, 0.46, 0.20 } }, { 1, { 0.45, 0.24, 0.09 } } },
    agate = { { 0, { 0.30, 0.08, 0.04 } }, { 0.3, { 0.72, 0.32, 0.14 } }, { 0.5, { 0.93, 0.80, 0.62 } }, { 0.7, { 0.66, 0.36, 0.22 } },
        { 1, { 0.96, 0.90, 0.82 } } },
    granite = { { 0, { 0.05, 0.05, 0.06 } }, { 0.35, { 0.38, 0.33, 0.32 } }, { 0.5, { 0.62, 0.55, 0.52 } }, { 1, { 0.93, 0.90, 0.88 } } },
    leopard = { { 0, { 0.85, 0.62, 0.30 } }, { 0.25, { 0.80, 0.50, 0.18 } }, { 0.4, { 0.09, 0.05, 0.02 } }, { 1, { 0.05, 0.03, 0.01 } } },
    sky = { { 0, { 0.14, 0.32, 0.68 } }, { 0.45, { 0.30, 0.50, 0.82 } }, { 0.75, { 0.92, 0.94, 0.96 } }, { 1, { 1, 1, 1 } } },
}

--- The colour of a map at t: linear between its entries, constant before the first and after the last. Two entries at
--- one position are a discontinuity.
---@param map string|table[]  the name of one of patterns.maps, or {{position, colour or number}, ...} by ascending positions
---@param t number
---@return number[]|number
function M.map(map, t)
    local list = map
    if type(map) == 'string' then
        list = M.maps[map]
        if not list then
            local names = {}
            for name in pairs(M.maps) do names[#names + 1] = name end
            table.sort(names)
            check.fail('patterns.map', ("there is no map '%s'; there are %s"):format(map:sub(1, 40), table.concat(names, ', ')))
        end
    end
    check.list('patterns.map', 'map', list, 1)
    local function colour(k)
        local value = list[k][2]
        if type(value) == 'number' then return check.number('patterns.map', ('map[%d][2]'):format(k), value) end
        return gr.vec(check.tuple('patterns.map', ('map[%d][2]'):format(k), value, 3))
    end
    for k, entry in ipairs(list) do
        check.table('patterns.map', ('map[%d]'):format(k), entry)
        check.number('patterns.map', ('map[%d][1]'):format(k), entry[1])
    end
    local out = colour(1)
    for k = 2, #list do
        local low, high = list[k - 1][1], list[k][1]
        if high < low then check.fail('patterns.map', ('the position of map[%d] must not be below the one before'):format(k)) end
        local share = high > low and gr.clamp((t - low) / (high - low), 0, 1) or gr.step(high, t)
        out = gr.mix(out, colour(k), share)
    end
    return out
end

-- Every pattern is called with a point; only M.map takes none.
for name, pattern in pairs(M) do
    if type(pattern) == 'function' and name ~= 'map' then
        M[name] = function(p, ...)
            local kind = type(p)
            if kind ~= 'table' and kind ~= 'userdata' or p[1] == nil then
                check.fail('patterns.' .. name, ('p must be a point {x, y, z}, not %s'):format(kind == 'table' and 'a table without one' or check.shown(p)))
            end
            return pattern(p, ...)
        end
    end
end

return M
