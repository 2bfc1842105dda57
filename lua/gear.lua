-- gear: wheels with involute teeth, rings, racks, and the positions at which they mesh.
-- Source: D. W. Dudley, "Handbook of Practical Gear Design", 1984; DIN 3960 (profile shift, working pressure angle).
-- Idea: the flank of a tooth is the involute of the base circle, r_b = r cos(pressure); at radius q the tooth reaches
-- from its middle line to the angle  pi/2z + 2 x tan(pressure)/z + inv(pressure) - inv(acos(r_b / q)),  inv(a) = tan a - a.
-- Below the base circle the flank is straight to the root.
-- Invariant: outlines run counter-clockwise with a tooth (of a ring: a gap) on the +x axis; two wheels that
-- gear.mate or gear.angle puts together touch and do not intersect at any angle.
--
--   local gear = require 'gear'
--   local big, small = gear.new {teeth = 36, module = 0.1}, gear.new {teeth = 18, module = 0.1}
--   local distance, angle = gear.mate(big, small, 10)       -- with the big one turned by 10 degrees, the small one in +x
--   scene:add_child(gr.prism {outline = gear.outline(big), holes = {gear.circle(0.3)}, material = brass})

local check = require 'check'
local meshes = require 'meshes'

local M = {}

local pi, sin, cos, tan, acos, sqrt = math.pi, math.sin, math.cos, math.tan, math.acos, math.sqrt

local function inv(a) return tan(a) - a end

--- A wheel.
---@param options table  teeth: at least 4; module: pitch diameter over teeth (1); pressure: angle in degrees, 10 to 30 (20);
---  shift: of the profile, in modules (0); addendum (1), dedendum (1.25): of the tooth above and below the pitch
---  circle, in modules; backlash: reduction of each tooth's width at the pitch circle (0); inside: a ring with teeth
---  inwards (false)
---@return table gear  with radius (pitch), base, tip, root besides
function M.new(options)
    local where = 'gear.new'
    options = check.options(where, options, 'teeth module pressure shift addendum dedendum backlash inside')
    local g = {
        teeth = check.whole(where, 'teeth', options.teeth, 4, 10000),
        module = check.above(where, 'module', options.module, 0, 1),
        pressure = check.number(where, 'pressure', options.pressure, 10, 30, 20),
        shift = check.number(where, 'shift', options.shift, -1, 1, 0),
        addendum = check.above(where, 'addendum', options.addendum, 0, 1),
        dedendum = check.above(where, 'dedendum', options.dedendum, 0, 1.25),
        backlash = check.number(where, 'backlash', options.backlash, 0, nil, 0),
        inside = check.flag(where, 'inside', options.inside),
    }
    local m, a = g.module, math.rad(g.pressure)
    g.radius = m * g.teeth / 2
    g.base = g.radius * cos(a)
    -- the gaps of a ring have the shape of a wheel's teeth: they extend to its root
    local out, back = g.inside and g.dedendum or g.addendum, g.inside and g.addendum or g.dedendum
    g.outer, g.inner = g.radius + m * (out + g.shift), g.radius - m * (back - g.shift)
    g.tip, g.root = g.inside and g.inner or g.outer, g.inside and g.outer or g.inner
    if g.inner <= 0 then check.fail(where, 'dedendum is larger than the wheel') end
    -- the tips of a rack would undercut teeth with a full root (Dudley 3.5)
    local least = 1 - g.teeth * sin(a) ^ 2 / 2
    if not g.inside and g.shift < least - 0.01 then
        check.fail(where, ('%d teeth are too few for a pressure angle of %g degrees: it takes %d, or a shift of %.3f'):format(
            g.teeth, g.pressure, math.ceil(2 / sin(a) ^ 2 - 0.2), least))
    end
    g.half = pi / (2 * g.teeth) + 2 * g.shift * tan(a) / g.teeth + inv(a) +
        (g.inside and 1 or -1) * g.backlash / (2 * g.radius)
    if g.half - inv(acos(g.base / g.outer)) <= 0 then check.fail(where, 'the teeth are pointed before they reach their tip') end
    return g
end

local function checked(where, g, name)
    if type(g) ~= 'table' or not g.half or not g.teeth then check.fail(where, (name or 'gear') .. ' must be made by gear.new') end
    return g
end

--- The outline of a wheel, or of the hole in a ring.
---@param g table
---@param points integer?  on each flank, default 8
---@return number[][] outline  points {x, y}, counter-clockwise
function M.outline(g, points)
    checked('gear.outline', g)
    points = check.whole('gear.outline', 'points', points, 2, 1000, 8)
    local out, pitch = {}, 2 * pi / g.teeth
    local low = math.max(g.base, g.inner)
    local flank = {}
    for k = 0, points - 1 do
        -- uniform in the roll angle, which matches the curvature
        local from, to = sqrt((low / g.base) ^ 2 - 1), sqrt((g.outer / g.base) ^ 2 - 1)
        local roll = from + (to - from) * k / (points - 1)
        local q = g.base * sqrt(1 + roll * roll)
        flank[k + 1] = { q, g.half - inv(math.atan(roll)) }
    end
    if g.inner < g.base then table.insert(flank, 1, { g.inner, flank[1][2] }) end
    local tip, root = flank[#flank][2], flank[1][2]
    local function add(q, angle) out[#out + 1] = { q * cos(angle), q * sin(angle) } end
    for tooth = 0, g.teeth - 1 do
        local middle = tooth * pitch
        for k = 1, #flank do add(flank[k][1], middle - flank[k][2]) end
        for k = 1, 2 do add(g.outer, middle - tip + 2 * tip * k / 3) end
        for k = #flank, 1, -1 do add(flank[k][1], middle + flank[k][2]) end
        local gap = pitch - 2 * root
        if gap > 1e-9 then
            for k = 1, 2 do add(g.inner, middle + root + gap * k / 3) end
        end
    end
    return out
end

--- A circle as an outline.
---@param radius number
---@param n integer?  corners, default 48
---@param x number?
---@param y number?
function M.circle(radius, n, x, y)
    check.above('gear.circle', 'radius', radius, 0)
    n = check.whole('gear.circle', 'n', n, 3, 100000, 48)
    local out = {}
    for k = 0, n - 1 do
        out[k + 1] = { (x or 0) + radius * cos(2 * pi * k / n), (y or 0) + radius * sin(2 * pi * k / n) }
    end
    return out
end

--- Position of a second wheel: its distance and its rotation.
---@param a table  the first, turned by `turn` degrees; may be a ring
---@param b table  the second, beside the first (or in the ring)
---@param turn number?  degrees, default 0
---@param toward number?  the direction from the first to the second in degrees, default 0: +x
---@return number distance  of the axes
---@return number angle  of the second, in degrees, counter-clockwise
function M.mate(a, b, turn, toward)
    local where = 'gear.mate'
    checked(where, a, 'a')
    checked(where, b, 'b')
    check.number(where, 'turn', turn, nil, nil, 0)
    check.number(where, 'toward', toward, nil, nil, 0)
    if math.abs(a.module - b.module) > 1e-9 * a.module or a.pressure ~= b.pressure then
        check.fail(where, 'wheels mesh only with the same module and pressure angle')
    end
    if b.inside then check.fail(where, 'b must not be a ring: give the ring first') end
    local sign = a.inside and -1 or 1
    local teeth, shift, alpha = a.teeth + sign * b.teeth, a.shift + sign * b.shift, math.rad(a.pressure)
    if teeth <= 0 then check.fail(where, 'a ring must have more teeth than the wheel in it') end
    local distance = a.module * teeth / 2
    if shift ~= 0 then
        local wanted, x = inv(alpha) + 2 * tan(alpha) * shift / teeth, alpha
        for _ = 1, 50 do x = x - (inv(x) - wanted) / tan(x) ^ 2 end -- Newton: the derivative of inv is tan^2
        distance = distance * cos(alpha) / cos(x)
    end
    local theta, psi = toward or 0, turn or 0
    if a.inside then return distance, theta + (psi - theta) * a.teeth / b.teeth end
    return distance, theta + 180 + 180 / b.teeth + (theta - psi) * a.teeth / b.teeth
end

--- A toothed rack along x: its teeth point to +y and its pitch line is y = 0; a gap is at x = 0, for a wheel above it
--- with a tooth that points straight down.
---@param g table  a wheel it fits: module, pressure, addendum, dedendum, backlash
---@param teeth integer
---@param thickness number  under the roots, in modules
---@return number[][] outline
function M.rack(g, teeth, thickness)
    local where = 'gear.rack'
    checked(where, g)
    check.whole(where, 'teeth', teeth, 1, 10000)
    check.above(where, 'thickness', thickness, 0)
    local m, slope = g.module, tan(math.rad(g.pressure))
    local pitch, top, bottom = pi * m, g.addendum * m, -g.dedendum * m
    local half = pitch / 4 - g.backlash / 2
    local out = {}
    local left = -teeth / 2 * pitch
    local right = -left
    out[1], out[2] = { left, bottom - thickness * m }, { right, bottom - thickness * m }
    out[3] = { right, bottom }
    for k = teeth - 1, 0, -1 do
        local middle = left + (k + 0.5) * pitch + (teeth % 2 == 1 and pitch / 2 or 0)
        if middle + half - slope * bottom <= right + 1e-9 then
            out[#out + 1] = { middle + half - slope * bottom, bottom }
            out[#out + 1] = { middle + half - slope * top, top }
            out[#out + 1] = { middle - half + slope * top, top }
            out[#out + 1] = { middle - half + slope * bottom, bottom }
        end
    end
    out[#out + 1] = { left, bottom }
    return out
end

--- A wheel (or ring) as a mesh about the z axis, optionally with slanted teeth: a helical or, doubled, a herringbone
--- wheel.
---@param g table
---@param options table?  width: along the axis (module * 6), bore: radius of the hole (none; a ring: its outer radius,
---  root + 2 modules), helix: degrees at the pitch circle (0), double: the slant is reversed in the middle (false),
---  points: on each flank (8), layers: along the axis (1, or 8 with a helix)
---@return number[][] verts
---@return number[][] normals
---@return integer[][] faces
---@return integer[][] face_normals
function M.mesh(g, options)
    local where = 'gear.mesh'
    checked(where, g)
    options = check.options(where, options, 'width bore helix double points layers')
    local width = check.above(where, 'width', options.width, 0, 6 * g.module)
    local helix = check.number(where, 'helix', options.helix, -60, 60, 0)
    local double = check.flag(where, 'double', options.double)
    local layers = check.whole(where, 'layers', options.layers, 1, 1000, helix ~= 0 and 8 or 1)
    if double and layers % 2 == 1 then layers = layers + 1 end
    local bore = options.bore
    if g.inside then
        bore = check.above(where, 'bore', bore, g.root, g.root + 2 * g.module)
    elseif bore ~= nil then
        check.above(where, 'bore', bore, 0)
        if bore >= g.root then check.fail(where, 'bore must be smaller than the root circle') end
    end
    local outline = M.outline(g, options.points)
    local n, verts, faces = #outline, {}, {}
    for layer = 0, layers do
        local z = layer / layers
        local along = double and 0.5 - math.abs(z - 0.5) or z
        local turn = tan(math.rad(helix)) * along * width / g.radius
        local c, s = cos(turn), sin(turn)
        for _, p in ipairs(outline) do
            verts[#verts + 1] = { p[1] * c - p[2] * s, p[1] * s + p[2] * c, (z - 0.5) * width }
        end
    end
    local function wall(below, above, count, turned)
        for k = 0, count - 1 do
            local next_k = (k + 1) % count
            local face = { below + k, below + next_k, above + next_k, above + k }
            if turned then face = { face[4], face[3], face[2], face[1] } end
            faces[#faces + 1] = face
        end
    end
    for layer = 0, layers - 1 do wall(layer * n, (layer + 1) * n, n, g.inside) end
    if not bore then
        local bottom, top = {}, {}
        for k = 0, n - 1 do bottom[n - k], top[k + 1] = k, layers * n + k end
        faces[#faces + 1], faces[#faces + 2] = bottom, top
    else
        -- the other circle has a corner for each corner of the outline, at the same angle: the end faces are rings of
        -- quads
        local first = #verts
        for level = 0, 1 do
            local from = level * layers * n
            for k = 1, n do
                local p = verts[from + k]
                local q = sqrt(p[1] ^ 2 + p[2] ^ 2)
                verts[#verts + 1] = { p[1] / q * bore, p[2] / q * bore, p[3] }
            end
        end
        wall(first, first + n, n, not g.inside)
        for k = 0, n - 1 do
            local next_k, top = (k + 1) % n, layers * n
            local a, b = { k, first + k, first + next_k, next_k }, { top + next_k, first + n + next_k, first + n + k, top + k }
            if g.inside then a, b = { a[4], a[3], a[2], a[1] }, { b[4], b[3], b[2], b[1] } end
            faces[#faces + 1], faces[#faces + 2] = a, b
        end
    end
    local mesh = meshes.smooth(verts, faces, 35)
    return mesh[1], mesh[2], mesh[3], mesh[4]
end

--- A planetary train: sun in the middle, planets around it, a fixed ring outside.
---@param options table  sun, planet: numbers of teeth; planets: how many (3); turn: of the sun in degrees (0); module,
---  pressure, backlash as for gear.new
---@return table train  sun, planet, ring: gears; sun_angle, ring_angle, carrier_angle in degrees; planets: a list of
---  { x, y, angle }
function M.planetary(options)
    local where = 'gear.planetary'
    options = check.options(where, options, 'sun planet planets turn module pressure backlash')
    local s, p = check.whole(where, 'sun', options.sun, 4), check.whole(where, 'planet', options.planet, 4)
    local count = check.whole(where, 'planets', options.planets, 1, 100, 3)
    local turn = check.number(where, 'turn', options.turn, nil, nil, 0)
    local r = s + 2 * p
    if (s + r) % count ~= 0 then
        check.fail(where, ('%d planets do not fit evenly: sun and ring have %d teeth together, which %d does not divide'):format(count, s + r, count))
    end
    local function wheel(teeth, inside)
        return M.new { teeth = teeth, inside = inside, module = options.module, pressure = options.pressure, backlash = options.backlash }
    end
    local train = { sun = wheel(s), planet = wheel(p), ring = wheel(r, true), planets = {}, sun_angle = turn }
    local carrier = turn * s / (s + r)
    -- the ring is rotated so that the first planet meshes with both: sun and ring must give the planet the same angle
    local _, by_sun = M.mate(train.sun, train.planet, 0, 0)
    train.ring_angle = by_sun * p / r
    train.carrier_angle = carrier
    for k = 0, count - 1 do
        local theta = carrier + 360 * k / count
        local distance, angle = M.mate(train.sun, train.planet, turn, theta)
        train.planets[k + 1] = { distance * cos(math.rad(theta)), distance * sin(math.rad(theta)), angle }
    end
    return train
end

return M
