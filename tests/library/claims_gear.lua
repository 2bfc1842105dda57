local gear, meshes = require 'gear', require 'meshes'
local claims = require 'claims'
local near = claims.near
local grey = gr.material({ .5, .5, .5 }, { 0, 0, 0 }, 1)
local pi = math.pi

local function area(outline)
    local twice = 0
    for k, p in ipairs(outline) do
        local q = outline[k % #outline + 1]
        twice = twice + p[1] * q[2] - p[2] * q[1]
    end
    return twice / 2
end

local function turned(outline, degrees, x, y)
    local c, s, out = math.cos(math.rad(degrees)), math.sin(math.rad(degrees)), {}
    for k, p in ipairs(outline) do out[k] = { x + p[1] * c - p[2] * s, y + p[1] * s + p[2] * c } end
    return out
end

local function inside(outline, p)
    local odd = false
    for k, a in ipairs(outline) do
        local b = outline[k % #outline + 1]
        if (a[2] > p[2]) ~= (b[2] > p[2]) and p[1] < a[1] + (p[2] - a[2]) * (b[1] - a[1]) / (b[2] - a[2]) then odd = not odd end
    end
    return odd
end

-- The distance from a point to the outline; pieces further away than `reach` along either axis are skipped.
local function distance(outline, p, reach)
    local least, x, y = reach * reach, p[1], p[2]
    for k, a in ipairs(outline) do
        local b = outline[k % #outline + 1]
        if math.abs(a[1] - x) < reach and math.abs(a[2] - y) < reach then
            local dx, dy = b[1] - a[1], b[2] - a[2]
            local t = math.max(0, math.min(1, ((x - a[1]) * dx + (y - a[2]) * dy) / (dx * dx + dy * dy)))
            least = math.min(least, (x - a[1] - t * dx) ^ 2 + (y - a[2] - t * dy) ^ 2)
        end
    end
    return math.sqrt(least)
end

-- The maximum depth to which the outlines intersect, and their smallest distance; only points near the contact count.
local function contact(a, b, x, y, reach)
    local depth, gap = 0, math.huge
    for k, one in ipairs { a, b } do
        local other = k == 1 and b or a
        for _, p in ipairs(one) do
            if (p[1] - x) ^ 2 + (p[2] - y) ^ 2 < reach * reach then
                local d = distance(other, p, 1)
                if inside(other, p) then depth = math.max(depth, d) end
                gap = math.min(gap, d)
            end
        end
    end
    return depth, gap
end

claims.claim('a tooth is half a pitch thick at the pitch circle, less the backlash', function()
    local g = gear.new { teeth = 24, module = 2, backlash = 0.1 }
    local a = math.rad(20)
    local half = g.half - (math.tan(a) - a)
    near(2 * half * g.radius, pi * 2 / 2 - 0.1, 1e-12, 'thickness')
    near(g.radius, 24, 1e-12, 'pitch radius')
    near(g.tip - g.root, 2 * 2.25, 1e-12, 'height')
end)

claims.claim('outlines lie between root and tip and have a point for each tooth on the axis of symmetry', function()
    local g = gear.new { teeth = 19 }
    local outline = gear.outline(g)
    for _, p in ipairs(outline) do
        local q = math.sqrt(p[1] ^ 2 + p[2] ^ 2)
        assert(q > g.root - 1e-9 and q < g.tip + 1e-9)
    end
    assert(inside(outline, { g.tip - 0.1, 0 }) and not inside(outline, turned({ { g.tip - 0.1, 0 } }, 180 / 19, 0, 0)[1]))
    -- about half of the ring between root and tip is tooth
    assert(area(outline) > pi * g.root ^ 2 and area(outline) < pi * g.tip ^ 2)
end)

claims.claim('wheels that mate touch and do not cut into each other at any angle', function()
    for _, pair in ipairs { { 36, 18, 0, 0 }, { 20, 20, 0.3, 0.2 }, { 12, 24, 0.4, 0 } } do
        local a = gear.new { teeth = pair[1], shift = pair[3] }
        local b = gear.new { teeth = pair[2], shift = pair[4] }
        local outline_a, outline_b = gear.outline(a, 12), gear.outline(b, 12)
        for turn = 0, 14, 7 do
            local toward = 3 * turn
            local d, angle = gear.mate(a, b, turn, toward)
            local x, y = d * math.cos(math.rad(toward)), d * math.sin(math.rad(toward))
            local mid = a.radius / (a.radius + b.radius)
            local depth, gap = contact(turned(outline_a, turn, 0, 0), turned(outline_b, angle, x, y), x * mid, y * mid, 2.6)
            assert(depth < 0.006, ('%d and %d teeth at %g degrees: %g deep'):format(pair[1], pair[2], turn, depth))
            assert(gap < 0.01, ('%d and %d teeth at %g degrees: %g apart'):format(pair[1], pair[2], turn, gap))
        end
    end
end)

claims.claim('a wheel in a ring touches and does not cut into it', function()
    local ring, planet = gear.new { teeth = 60, inside = true }, gear.new { teeth = 20 }
    local hole, outline = gear.outline(ring, 12), gear.outline(planet, 12)
    for turn = 0, 8, 4 do
        local d, angle = gear.mate(ring, planet, turn, 25)
        local x, y = d * math.cos(math.rad(25)), d * math.sin(math.rad(25))
        local gap = math.huge
        for _, p in ipairs(turned(outline, angle, x, y)) do
            local back = turned({ p }, -turn, 0, 0)[1] -- into the ring's own frame
            local e = distance(hole, back, 1)
            gap = math.min(gap, e)
            assert(inside(hole, back) or e < 0.006, ('%g outside at %g'):format(e, turn))
        end
        assert(gap < 0.01)
    end
end)

claims.claim('planets fit sun and ring', function()
    local train = gear.planetary { sun = 24, planet = 18, planets = 3, turn = 33 }
    assert(train.ring.teeth == 60)
    near(train.carrier_angle, 33 * 24 / 84, 1e-12, 'carrier')
    local hole = turned(gear.outline(train.ring, 8), train.ring_angle, 0, 0)
    local sun = turned(gear.outline(train.sun, 8), train.sun_angle, 0, 0)
    for _, p in ipairs(train.planets) do
        local planet = turned(gear.outline(train.planet, 8), p[3], p[1], p[2])
        for k = 1, #planet, 3 do
            local q = planet[k]
            assert(inside(hole, q) or distance(hole, q, 1) < 0.01, 'planet cuts the ring')
            assert(not inside(sun, q) or distance(sun, q, 1) < 0.01, 'planet cuts the sun')
        end
    end
end)

claims.claim('a rack takes the teeth of a wheel that rolls on it', function()
    local g = gear.new { teeth = 20 }
    local rack, wheel = gear.rack(g, 10, 1), gear.outline(g, 12)
    for turn = 0, 18, 6 do
        -- a tooth points down at -90 degrees; a turn rolls the wheel to -x * ... by its arc
        local at = -math.rad(turn) * g.radius
        local depth, gap = contact(rack, turned(wheel, -90 + turn, at, g.radius), at, 0, 4)
        assert(depth < 0.006 and gap < 0.01, ('%g deep, %g apart at %g'):format(depth, gap, turn))
    end
end)

claims.claim('meshes of wheels are closed, with the volume of their outline', function()
    local g = gear.new { teeth = 18, module = 0.2 }
    local scene = gr.node 'scene'
    for _, options in ipairs { {}, { bore = 0.5 }, { bore = 0.5, helix = 20 }, { helix = 25, double = true } } do
        options.width = 1.5
        local verts, normals, faces, face_normals = gear.mesh(g, options)
        assert(meshes.is_closed(faces))
        local v, e, f = meshes.euler(faces)
        assert(v - e + f == (options.bore and 0 or 2))
        if not options.helix then
            local hole = 0
            if options.bore then -- its corners have the angles of the outline's corners
                local circle = {}
                for k, p in ipairs(gear.outline(g)) do
                    local q = math.sqrt(p[1] ^ 2 + p[2] ^ 2)
                    circle[k] = { p[1] / q * 0.5, p[2] / q * 0.5 }
                end
                hole = area(circle)
            end
            near(meshes.volume(verts, faces), 1.5 * (area(gear.outline(g)) - hole), 1e-9, 'volume')
        end
        scene:add_child(gr.difference('cut', gr.vn_mesh(grey, verts, normals, faces, face_normals), gr.nh_box(grey, { 0, 0, 0 }, 1)))
    end
    local ring = gear.new { teeth = 60, module = 0.2, inside = true }
    local verts, _, faces = gear.mesh(ring)
    assert(meshes.is_closed(faces) and meshes.volume(verts, faces) > 0)
    claims.build(scene)
end)

claims.claim('faces without area do not bend the normals of a wheel', function()
    -- between root circle and bore, quads have two corners at one point
    for _, bore in ipairs { 0.3, 0.5 } do
        local g = gear.new { teeth = 18, module = 0.1 }
        local verts, normals, faces, face_normals = gear.mesh(g, { width = 0.4, bore = bore })
        local without_area = 0
        for k, face in ipairs(faces) do
            local x, y, z = meshes.face_normal(verts, face)
            local length = math.sqrt(x * x + y * y + z * z)
            if length < 1e-14 then
                without_area = without_area + 1
            else
                for i = 1, #face do
                    local n = normals[face_normals[k][i] + 1]
                    local cosine = (n[1] * x + n[2] * y + n[3] * z) / length
                    assert(cosine > math.cos(math.rad(18)), 'a normal is turned from its face') -- half the crease angle
                end
            end
        end
        assert(without_area > 0, 'the wheel has such faces')
    end
end)

claims.claim('faces without area do not count where a mesh is smooth everywhere', function()
    local verts = { { 0, 0, 0 }, { 1, 0, 0 }, { 1, 0, 1 }, { 0, 0, 1 }, { 0.1, 0.1, 0.1 }, { 0.3, 0.3, 0.3 } }
    local mesh = meshes.smooth(verts, { { 3, 2, 1, 0 }, { 0, 4, 5 } })
    near(mesh[2][1][2], 1, 0, 'y of the normal at the corner')
    near(mesh[2][1][1], 0, 0, 'x of the normal at the corner')
end)

claims.claim('wrong arguments are named', function()
    claims.fails('gear.new: 10 teeth are too few for a pressure angle of 20 degrees: it takes 17, or a shift of 0.415', gear.new, { teeth = 10 })
    claims.fails('gear.new: teeth must be a whole number from 4 to 10000, not nothing', gear.new, {})
    claims.fails('gear.mate: wheels mesh only with the same module', gear.mate, gear.new { teeth = 20 }, gear.new { teeth = 20, module = 2 })
    claims.fails('gear.planetary: 5 planets do not fit evenly', gear.planetary, { sun = 24, planet = 18, planets = 5 })
end)
