local patterns, colour, easing, noise = require 'patterns', require 'colour', require 'easing', require 'noise'
local random = require 'random'
local claims = require 'claims'
local near = claims.near

local dice = random.new(18)
local function point(size) return gr.vec(dice:range(-size, size), dice:range(-size, size), dice:range(-size, size)) end

local all = { 'checker', 'gradient', 'bricks', 'hexagons', 'spots', 'clouds', 'turbulence', 'cells', 'marble', 'wood', 'agate', 'granite',
    'leopard', 'rings' }
local jumps = { checker = true, gradient = true, bricks = true, hexagons = true, cells = true }

claims.claim('every function of the module that takes a point is a pattern that is tested here', function()
    local known = { map = true }
    for _, name in ipairs(all) do known[name] = true end
    for name, f in pairs(patterns) do assert(type(f) ~= 'function' or known[name], name) end
end)

claims.claim('patterns give the same bits recorded and by Lua, of vectors and of tables', function()
    for _, name in ipairs(all) do
        local f = patterns[name]
        gr.fn(function(p) return (f(p)) end)
        gr.fn(function(p) return (f { p.y, p.z, p.x }) end)
        local p = point(3)
        assert(f(p) == f { p.x, p.y, p.z }, name)
    end
    gr.fn(function(p) return select(2, patterns.bricks(p, { size = { 2, 1, 1 }, joint = 0.1, bevel = 0.05 })) end)
    gr.fn(function(p) return (patterns.bricks(p, { bevel = 0.05 })) end)
    gr.fn(function(p) return select(2, patterns.hexagons(p)) end)
    gr.fn(function(p) return select(2, patterns.cells(p)) end)
    gr.fn(function(p) return patterns.spots(p, p.x * p.x + 0.1, 0.5) end)
    for name in pairs(patterns.maps) do gr.fn(function(p) return patterns.map(name, patterns.marble(p)) end) end
    gr.fn(function(p) return patterns.map({ { 0, 1 }, { 0.5, 3 }, { 0.5, 2 }, { 1, 0 } }, p.x) end)
end)

claims.claim('patterns are numbers from 0 to 1, and use most of them', function()
    for _, name in ipairs(all) do
        local low, high, top = math.huge, -math.huge, name == 'hexagons' and 2 or name == 'turbulence' and 1.6 or 1
        for _ = 1, 4000 do
            local value = patterns[name](point(20))
            low, high = math.min(low, value), math.max(high, value)
        end
        assert(low >= 0 and high <= top, name)
        assert(low <= 0.25 and high >= 0.75, ('%s: %g to %g'):format(name, low, high))
    end
end)

claims.claim('checkers, gradients, rings, leopards and spots have their closed forms', function()
    for _ = 1, 2000 do
        local p = point(9)
        local x, y, z = math.floor(p.x), math.floor(p.y), math.floor(p.z)
        local inside = true
        for k = 1, 3 do inside = inside and p[k] % 1 < 0.998 end
        if inside then assert(patterns.checker(p) == (x + y + z) % 2) end
        if p.y % 1 < 0.998 then near(patterns.gradient(p), p.y % 1 + 1 / 1024, 1e-12, 'gradient') end
        near(patterns.rings(p), math.sin(math.pi * math.sqrt(p.x ^ 2 + p.z ^ 2)) ^ 2, 1e-9, 'rings')
        near(patterns.leopard(p), patterns.leopard(p + gr.vec(1, -2, 3)), 1e-9, 'leopard')
        local nearest = gr.cells(p)
        assert(patterns.spots(p, 0.3) == 1 == (nearest <= 0.24) and patterns.spots(p, 0.3) == 0 == (nearest >= 0.3))
    end
    near(patterns.gradient({ 3, 0, 0 }, { 4, 0, 0 }), 0.75 + 1 / 1024, 1e-12, 'a gradient over 4')
    near(patterns.leopard { 0.25, 0.25, 0.25 }, 1, 1e-12, 'the middle of a spot')
end)

claims.claim('a wall has joints of their width in shifted courses', function()
    local inside, count = 0, 200000
    for _ = 1, count do inside = inside + patterns.bricks(point(30)) end
    near(inside / count, (1 - 0.04) * (1 - 0.04 / 0.35) * (1 - 0.04 / 0.5), 0.005, 'share of bricks')
    assert(patterns.bricks { 0.5, 0.17, 0.25 } == 1 and patterns.bricks { 0, 0.17, 0.25 } == 0)
    assert(patterns.bricks { 0.5, 0.17 + 0.35, 0 } == 0 and patterns.bricks { 0, 0.17 + 0.35, 0 } == 1)
    local _, a = patterns.bricks { 0.2, 0.1, 0.1 }
    local _, b = patterns.bricks { 0.8, 0.3, 0.4 }
    local _, c = patterns.bricks { 1.2, 0.1, 0.1 }
    assert(a == b and a ~= c)
end)

claims.claim('hexagons of one kind never touch, and their edges are half a unit from each other', function()
    local seen = { 0, 0, 0 }
    for _ = 1, 20000 do
        local p = point(20)
        local kind, inside = patterns.hexagons(p)
        assert(inside >= -1e-9 and inside <= math.sqrt(3) / 4 + 1e-9)
        seen[math.tointeger(kind) + 1] = seen[math.tointeger(kind) + 1] + 1
        local angle = dice:range(0, 2 * math.pi)
        local q = p + gr.vec(inside * 0.999 * math.cos(angle), 0, inside * 0.999 * math.sin(angle))
        if inside > 0.01 then assert(patterns.hexagons(q) == kind) end
    end
    for k = 1, 3 do near(seen[k] / 20000, 1 / 3, 0.02, 'share of a kind') end
    for k = 0, 5 do -- the six neighbours
        local angle = math.pi / 6 + k * math.pi / 3
        assert(patterns.hexagons { math.cos(angle) * math.sqrt(3) / 2, 0, math.sin(angle) * math.sqrt(3) / 2 } ~= patterns.hexagons { 0, 0, 0 })
    end
end)

-- Differences of the first and of the second order at planes of whole numbers are as small as elsewhere.
claims.claim('noise patterns have no seams at the planes of the lattice', function()
    for _, name in ipairs(all) do
        local f, h = patterns[name], 1e-5
        local function largest(on_lattice)
            local first = 0
            for i = 1, 3000 do
                local p = point(8)
                local q = { p.x, p.y, p.z }
                if on_lattice then q[i % 3 + 1] = math.floor(q[i % 3 + 1]) end
                local step = { 0, 0, 0 }
                step[i % 3 + 1] = h
                local a, b = f { q[1] - h * step[1] / h, q[2] - step[2], q[3] - step[3] }, f { q[1] + step[1], q[2] + step[2], q[3] + step[3] }
                first = math.max(first, math.abs(b - a))
            end
            return first
        end
        if not jumps[name] then
            local on, off = largest(true), largest(false)
            assert(on <= 1.5 * off + 1e-7, ('%s: %g at the lattice, %g elsewhere'):format(name, on, off))
        end
    end
    -- Sums of noise at whole numbers vary as they do elsewhere: no octave vanishes there.
    for _, name in ipairs { 'clouds', 'turbulence', 'granite' } do
        local function deviation(whole)
            local sum, square, count = 0, 0, 4000
            for _ = 1, count do
                local p = point(100)
                if whole then p = gr.vec(math.floor(p.x), math.floor(p.y), math.floor(p.z)) end
                local value = patterns[name](p)
                sum, square = sum + value, square + value * value
            end
            return math.sqrt(square / count - (sum / count) ^ 2)
        end
        near(deviation(true) / deviation(false), 1, 0.1, name)
    end
    -- The faces of a box at whole numbers are not torn by rounding.
    for _ = 1, 1000 do
        local p = point(9)
        local y = math.floor(p.y)
        for _, name in ipairs { 'checker', 'gradient', 'bricks' } do
            assert(patterns[name] { p.x, y - 1e-12, p.z } - patterns[name] { p.x, y + 1e-12, p.z } < 1e-9, name)
        end
    end
end)

claims.claim('maps go through their entries, and jump where two stand at one position', function()
    local map = { { 0.2, { 1, 0, 0 } }, { 0.6, { 0, 1, 0 } }, { 0.6, { 0, 0, 1 } }, { 1, { 1, 1, 1 } } }
    assert(patterns.map(map, -1) == gr.vec(1, 0, 0) and patterns.map(map, 0.2) == gr.vec(1, 0, 0))
    assert(patterns.map(map, 2) == gr.vec(1, 1, 1) and patterns.map(map, 0.6) == gr.vec(0, 0, 1))
    near(patterns.map(map, 0.4).g, 0.5, 1e-12, 'between')
    near(patterns.map(map, 0.5999999).g, 1, 1e-6, 'before the jump')
    near(patterns.map({ { 0, 2 }, { 1, 4 } }, 0.25), 2.5, 1e-12, 'numbers')
end)

claims.claim('noise, colours and easings of the library can be recorded', function()
    gr.fn(function(p) return noise.sum(p.x, p.y, p.z, 3) end)
    gr.fn(function(p, s) return colour.hsv(360 * s.u, s.v, 0.8) end)
    gr.fn(function(p, s) return colour.linear { s.u, s.v, s.time } end)
    gr.fn(function(p, s) return colour.srgb { s.u, s.v, s.time } end)
    gr.fn(function(p, s) return colour.palette('viridis', s.u) end)
    gr.fn(function(p, s) return colour.palette({ { 1, 0, 0 } }, s.u) end)
    gr.fn(function(p, s) return colour.blackbody(1000 + 9000 * s.u) end)
    gr.fn(function(p, s) return colour.cosine({ 0.5, 0.5, 0.5 }, { 0.5, 0.5, 0.5 }, { 1, 1, 1 }, { 0, 0.3, 0.6 }, p.x) end)
    gr.fn(function(p, s) return colour.oklab { s.u, 0.1 * s.v, 0 } end)
    gr.fn(function(p, s) return colour.blend({ 1, 0, 0 }, { 0, 0, 1 }, s.u) end)
    gr.fn(function(p, s) return (colour.to_hsv { s.u, s.v, s.time }) end)
    for name, f in pairs(easing) do
        if name ~= 'mix' and name ~= 'keys' then gr.fn(function(p) return f(p.x) end) end
    end
    gr.fn(function(p) return easing.keys({ { 0, { 0, 0, 0 } }, { 24, { 2, 1, 0 } }, { 48, { 0, 0, 0 } } }, p.x) end)
end)

claims.claim('wrong arguments are named', function()
    claims.fails('patterns.clouds: octaves must be a whole number from 1 to 16, not 0', function() patterns.clouds({ 0, 0, 0 }, 0) end)
    claims.fails('patterns.bricks: there is no option width', function() patterns.bricks({ 0, 0, 0 }, { width = 1 }) end)
    claims.fails("patterns.map: there is no map 'mahogany'; there are agate", function() patterns.map('mahogany', 0) end)
    claims.fails('patterns.map: the position of map[2] must not be below the one before', function() patterns.map({ { 1, 0 }, { 0, 1 } }, 0) end)
    claims.fails('patterns.map: map[1][2] must be a tuple of 3 numbers', function() patterns.map({ { 1 } }, 0) end)
    claims.fails('patterns.gradient: direction must not be {0, 0, 0}', function() patterns.gradient({ 0, 0, 0 }, { 0, 0, 0 }) end)
    claims.fails('octaves must be a whole number from 1 to 16, not a number of the recorded function', function()
        gr.fn(function(p) return patterns.clouds(p, p.x) end)
    end)
end)
