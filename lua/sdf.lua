-- sdf: solids as functions of a point that are negative inside, for gr.implicit. Most are distances from the surface, or
-- bounds of the distance. All are plain Lua: they can be called with numbers, or be recorded.
-- Idea: a solid is a function of a point; each function of this module makes one from lengths or from other solids.
-- Sources: J. Hart, "Sphere Tracing", The Visual Computer 12, 1996 (distances of primitives, operations on space);
-- A. Ricci, "A Constructive Geometry for Computer Graphics", The Computer Journal 16, 1973 (min and max);
-- I. Quilez, "Smooth minimum", 2013 (the polynomial blend); A. Schoen, "Infinite Periodic Minimal Surfaces", NASA TN D-5541,
-- 1970 (gyroid).
-- Zeros are floats (0.0): math.max(x, 0) is an integer or a float, which a recording has to distinguish.
-- Flat solids are functions of p.x and p.y alone; `extrude` and `revolve` make solids of them.
--
--   local sdf = require 'sdf'
--   local body = sdf.smooth_union(0.2, sdf.sphere(1), sdf.translate(sdf.sphere(0.6), {1, 0.4, 0}))
--   local node = gr.implicit{f = body, bounds = {{-2, -2, -2}, {2, 2, 2}}}

local check = require 'check'

local M = {}

local abs, sqrt, sin, cos, floor, pi = math.abs, math.sqrt, math.sin, math.cos, math.floor, math.pi

---@alias sdf.solid fun(p: number[]): number

local function solids(where, list, least)
    if #list < least then check.fail('sdf.' .. where, ('%d or more solids are needed, not %d'):format(least, #list)) end
    for k, f in ipairs(list) do check.callable('sdf.' .. where, ('solid %d'):format(k), f) end
    return list
end

local function solid(where, f) return check.callable('sdf.' .. where, 'the solid', f) end

local function size(where, name, value, default) return check.above('sdf.' .. where, name, value, 0, default) end

local function hypot(x, y) return sqrt(x * x + y * y) end

local function abs_of(p) return gr.vec(abs(p[1]), abs(p[2]), abs(p[3])) end

--- The distance from the product of two sets, computed from the distances from each set.
local function product(a, b) return gr.min(gr.max(a, b), 0.0) + hypot(gr.max(a, 0.0), gr.max(b, 0.0)) end

-- --- solids around the origin ---

---@param radius number?  default 1
---@return sdf.solid
function M.sphere(radius)
    radius = size('sphere', 'radius', radius, 1)
    return function(p) return gr.length(p) - radius end
end

--- A box from -half to half.
---@param half number[]?  default {1, 1, 1}
---@return sdf.solid
function M.box(half)
    half = check.tuple('sdf.box', 'half', half, 3, { 1, 1, 1 })
    for k = 1, 3 do size('box', ('half[%d]'):format(k), half[k]) end
    return function(p)
        local q = abs_of(p) - half
        return gr.length(gr.max(q, 0.0)) + gr.min(gr.max(q.x, q.y, q.z), 0.0)
    end
end

--- A ring around y.
---@param major number?  radius of the ring, default 1
---@param minor number?  radius of its tube, default 0.25
---@return sdf.solid
function M.torus(major, minor)
    major, minor = size('torus', 'major', major, 1), size('torus', 'minor', minor, 0.25)
    return function(p) return hypot(hypot(p[1], p[3]) - major, p[2]) - minor end
end

--- A cylinder around y, from -half to half.
---@return sdf.solid
function M.cylinder(radius, half)
    radius, half = size('cylinder', 'radius', radius, 1), size('cylinder', 'half', half, 1)
    return function(p) return product(hypot(p[1], p[3]) - radius, abs(p[2]) - half) end
end

--- All points within a distance from a segment.
---@param from number[]
---@param to number[]
---@param radius number
---@param end_radius number?  radius at `to`; if it differs, the slope of the function is above 1
---@return sdf.solid
function M.capsule(from, to, radius, end_radius)
    from, to = gr.vec(check.tuple('sdf.capsule', 'from', from, 3)), gr.vec(check.tuple('sdf.capsule', 'to', to, 3))
    radius = size('capsule', 'radius', radius)
    end_radius = size('capsule', 'end_radius', end_radius, radius)
    local along = to - from
    local square = along:dot(along)
    if square == 0 then check.fail('sdf.capsule', 'from and to must differ') end
    return function(p)
        local d = gr.vec(p) - from
        local t = gr.clamp(d:dot(along) / square, 0.0, 1.0)
        return gr.length(d - along * t) - (radius + (end_radius - radius) * t)
    end
end

--- The half-space below a plane.
---@param normal number[]?  default {0, 1, 0}
---@param distance number?  from the origin along the normal, default 0
---@return sdf.solid
function M.plane(normal, distance)
    normal = gr.vec(check.tuple('sdf.plane', 'normal', normal, 3, { 0, 1, 0 }))
    distance = check.number('sdf.plane', 'distance', distance, nil, nil, 0)
    if normal:length() == 0 then check.fail('sdf.plane', 'normal must not be {0, 0, 0}') end
    normal = normal:normalize()
    return function(p) return gr.dot(p, normal) - distance end
end

--- An ellipsoid; a bound of the distance.
---@param radii number[]
---@return sdf.solid
function M.ellipsoid(radii)
    check.tuple('sdf.ellipsoid', 'radii', radii, 3)
    for k = 1, 3 do size('ellipsoid', ('radii[%d]'):format(k), radii[k]) end
    local least = math.min(radii[1], radii[2], radii[3])
    return function(p) return (gr.length(gr.vec(p) / radii) - 1) * least end
end

--- A wall around Schoen's gyroid; the function is close to the distance, its slope is at most 1.16.
---@param period number?  default 1
---@param thickness number?  of the wall, default a tenth of the period
---@return sdf.solid
function M.gyroid(period, thickness)
    period = size('gyroid', 'period', period, 1)
    thickness = size('gyroid', 'thickness', thickness, 0.1 * period)
    local k = 2 * pi / period
    return function(p)
        local x, y, z = k * p[1], k * p[2], k * p[3]
        return abs(sin(x) * cos(y) + sin(y) * cos(z) + sin(z) * cos(x)) / (1.5 * k) - thickness / 2
    end
end

-- --- flat solids ---

---@return sdf.solid
function M.circle(radius)
    radius = size('circle', 'radius', radius, 1)
    return function(p) return hypot(p[1], p[2]) - radius end
end

--- A rectangle from -half to half.
---@return sdf.solid
function M.rectangle(half_x, half_y)
    half_x, half_y = size('rectangle', 'half_x', half_x, 1), size('rectangle', 'half_y', half_y, 1)
    return function(p) return product(abs(p[1]) - half_x, abs(p[2]) - half_y) end
end

--- A convex polygon with equal sides; a bound of the distance.
---@param sides integer
---@param radius number?  of the circle inside it, default 1
---@return sdf.solid
function M.polygon(sides, radius)
    sides, radius = check.whole('sdf.polygon', 'sides', sides, 3, 1000), size('polygon', 'radius', radius, 1)
    return function(p)
        local out = p[2]
        for k = 1, sides - 1 do out = gr.max(out, p[1] * sin(2 * pi * k / sides) + p[2] * cos(2 * pi * k / sides)) end
        return out - radius
    end
end

-- --- sets ---

--- Points in any of the solids.
---@param ... sdf.solid
---@return sdf.solid
function M.union(...)
    local list = solids('union', { ... }, 1)
    return function(p)
        local out = list[1](p)
        for k = 2, #list do out = gr.min(out, list[k](p)) end
        return out
    end
end

--- Points in all of the solids.
---@param ... sdf.solid
---@return sdf.solid
function M.intersection(...)
    local list = solids('intersection', { ... }, 1)
    return function(p)
        local out = list[1](p)
        for k = 2, #list do out = gr.max(out, list[k](p)) end
        return out
    end
end

--- Points in the first solid and in none of the others.
---@param ... sdf.solid
---@return sdf.solid
function M.difference(...)
    local list = solids('difference', { ... }, 1)
    return function(p)
        local out = list[1](p)
        for k = 2, #list do out = gr.max(out, -list[k](p)) end
        return out
    end
end

-- min(a, b), rounded where they differ by less than the width: Quilez's polynomial of degree 2.
local function smooth_min(a, b, width)
    local h = gr.max(1 - abs(a - b) / width, 0.0)
    return gr.min(a, b) - 0.25 * width * h * h
end

--- A union with fillets.
---@param width number  of the fillets
---@param ... sdf.solid
---@return sdf.solid
function M.smooth_union(width, ...)
    local list = solids('smooth_union', { ... }, 1)
    size('smooth_union', 'width', width)
    return function(p)
        local out = list[1](p)
        for k = 2, #list do out = smooth_min(out, list[k](p), width) end
        return out
    end
end

--- An intersection with rounded edges.
---@return sdf.solid
function M.smooth_intersection(width, ...)
    local list = solids('smooth_intersection', { ... }, 1)
    size('smooth_intersection', 'width', width)
    return function(p)
        local out = list[1](p)
        for k = 2, #list do out = -smooth_min(-out, -list[k](p), width) end
        return out
    end
end

--- A difference with rounded edges.
---@return sdf.solid
function M.smooth_difference(width, ...)
    local list = solids('smooth_difference', { ... }, 1)
    size('smooth_difference', 'width', width)
    return function(p)
        local out = list[1](p)
        for k = 2, #list do out = -smooth_min(-out, list[k](p), width) end
        return out
    end
end

-- --- surfaces ---

--- The solid extended by a radius: a box gets round edges.
---@return sdf.solid
function M.round(f, radius)
    solid('round', f)
    check.number('sdf.round', 'radius', radius)
    return function(p) return f(p) - radius end
end

--- A wall around the surface, on both sides of it.
---@return sdf.solid
function M.shell(f, thickness)
    solid('shell', f)
    size('shell', 'thickness', thickness)
    return function(p) return abs(f(p)) - thickness / 2 end
end

-- --- operations on space ---

---@param by number[]
---@return sdf.solid
function M.translate(f, by)
    solid('translate', f)
    check.tuple('sdf.translate', 'by', by, 3)
    return function(p) return f(gr.vec(p) - by) end
end

local axes = { x = { 2, 3, 1 }, y = { 3, 1, 2 }, z = { 1, 2, 3 } }

-- p rotated backwards by an angle about an axis. The angle may depend on the point.
local function turned(p, axis, angle)
    local i, j, k = axis[1], axis[2], axis[3]
    local c, s, out = cos(angle), sin(angle), {}
    out[i], out[j], out[k] = c * p[i] + s * p[j], c * p[j] - s * p[i], p[k]
    return gr.vec(out)
end

--- Rotated counterclockwise, seen from the end of the axis.
---@param axis 'x'|'y'|'z'
---@param degrees number
---@return sdf.solid
function M.rotate(f, axis, degrees)
    solid('rotate', f)
    local order = axes[check.word('sdf.rotate', 'axis', axis, 'x y z')]
    check.number('sdf.rotate', 'degrees', degrees)
    return function(p) return f(turned(p, order, degrees * pi / 180)) end
end

---@param factor number
---@return sdf.solid
function M.scale(f, factor)
    solid('scale', f)
    size('scale', 'factor', factor)
    return function(p) return f(gr.vec(p) / factor) * factor end
end

--- The half at x > 0, and its mirror image.
---@return sdf.solid
function M.mirror(f)
    solid('mirror', f)
    return function(p) return f(gr.vec(abs(p[1]), p[2], p[3])) end
end

--- Rotated about y by an angle proportional to y.
---@param degrees number  in a unit of height
---@return sdf.solid
function M.twist(f, degrees)
    solid('twist', f)
    check.number('sdf.twist', 'degrees', degrees)
    return function(p) return f(turned(p, axes.y, p[2] * degrees * pi / 180)) end
end

--- Bent upwards: rotated about z by an angle proportional to x.
---@param degrees number  in a unit along x
---@return sdf.solid
function M.bend(f, degrees)
    solid('bend', f)
    check.number('sdf.bend', 'degrees', degrees)
    return function(p) return f(turned(p, axes.z, p[1] * degrees * pi / 180)) end
end

--- Copies at the points of a lattice. The solid must be within half of the spacing.
---@param spacing number[]  0 for a direction without copies
---@param counts number[]?  copies on each side of the first; default infinitely many
---@return sdf.solid
function M.repeated(f, spacing, counts)
    solid('repeated', f)
    check.tuple('sdf.repeated', 'spacing', spacing, 3)
    for k = 1, 3 do check.number('sdf.repeated', ('spacing[%d]'):format(k), spacing[k], 0) end
    check.tuple('sdf.repeated', 'counts', counts, 3, { 0, 0, 0 })
    return function(p)
        local out = {}
        for k = 1, 3 do
            out[k] = p[k]
            if spacing[k] > 0 then
                local cell = floor(p[k] / spacing[k] + 0.5) + 0.0
                if counts then cell = gr.clamp(cell, 0.0 - counts[k], 0.0 + counts[k]) end
                out[k] = p[k] - spacing[k] * cell
            end
        end
        return f(gr.vec(out))
    end
end

--- A flat solid, along z from -half to half.
---@return sdf.solid
function M.extrude(f, half)
    solid('extrude', f)
    size('extrude', 'half', half)
    return function(p) return product(f(gr.vec(p[1], p[2], 0)), abs(p[3]) - half) end
end

--- A flat solid revolved about y.
---@param offset number?  its distance from the axis, default 0
---@return sdf.solid
function M.revolve(f, offset)
    solid('revolve', f)
    offset = check.number('sdf.revolve', 'offset', offset, nil, nil, 0)
    return function(p) return f(gr.vec(hypot(p[1], p[3]) - offset, p[2], 0)) end
end

return M
