local sdf, random = require 'sdf', require 'random'
local claims = require 'claims'
local near = claims.near

local dice = random.new(5)
local function point(size) return gr.vec(dice:range(-size, size), dice:range(-size, size), dice:range(-size, size)) end

-- One of each, with whether it is a distance (its gradient has the length 1).
local all = {
    sphere = { sdf.sphere(0.8), true }, box = { sdf.box { 0.5, 0.7, 0.9 }, true }, torus = { sdf.torus(0.8, 0.3), true },
    cylinder = { sdf.cylinder(0.6, 0.8), true }, capsule = { sdf.capsule({ -0.5, 0, 0.2 }, { 0.6, 0.5, 0 }, 0.3), true },
    plane = { sdf.plane({ 1, 2, 2 }, 0.3), true }, ellipsoid = { sdf.ellipsoid { 0.5, 0.9, 0.7 } }, gyroid = { sdf.gyroid(1.5) },
    circle = { sdf.circle(0.7), true }, rectangle = { sdf.rectangle(0.5, 0.8), true }, polygon = { sdf.polygon(5, 0.7), true },
    union = { sdf.union(sdf.sphere(0.5), sdf.box { 0.9, 0.2, 0.2 }), true },
    intersection = { sdf.intersection(sdf.sphere(0.8), sdf.box { 0.9, 0.4, 0.6 }), true },
    difference = { sdf.difference(sdf.sphere(0.8), sdf.cylinder(0.3, 2)), true },
    smooth_union = { sdf.smooth_union(0.3, sdf.sphere(0.5), sdf.box { 0.9, 0.2, 0.2 }) },
    smooth_intersection = { sdf.smooth_intersection(0.3, sdf.sphere(0.8), sdf.box { 0.9, 0.4, 0.6 }) },
    smooth_difference = { sdf.smooth_difference(0.2, sdf.sphere(0.8), sdf.cylinder(0.3, 2)) },
    round = { sdf.round(sdf.box { 0.5, 0.3, 0.3 }, 0.2), true }, shell = { sdf.shell(sdf.sphere(0.7), 0.1), true },
    translate = { sdf.translate(sdf.sphere(0.5), { 0.3, 0.2, -0.1 }), true }, rotate = { sdf.rotate(sdf.box { 0.9, 0.2, 0.3 }, 'y', 30), true },
    scale = { sdf.scale(sdf.torus(), 0.6), true }, mirror = { sdf.mirror(sdf.translate(sdf.sphere(0.3), { 0.5, 0, 0 })), true },
    twist = { sdf.twist(sdf.box { 0.3, 0.9, 0.3 }, 40) }, bend = { sdf.bend(sdf.box { 0.9, 0.1, 0.3 }, 40) },
    repeated = { sdf.repeated(sdf.sphere(0.2), { 0.5, 0.6, 0 }, { 1, 2, 0 }) },
    extrude = { sdf.extrude(sdf.circle(0.6), 0.4), true }, revolve = { sdf.revolve(sdf.circle(0.2), 0.6), true },
}

claims.claim('every function of the module is tested here', function()
    for name in pairs(sdf) do assert(all[name], name) end
end)

claims.claim('solids give the same bits recorded and by Lua, of vectors and of tables', function()
    for name, entry in pairs(all) do
        gr.fn(entry[1])
        local p = point(1)
        assert(entry[1](p) == entry[1] { p.x, p.y, p.z }, name)
    end
end)

claims.claim('distances have gradients of length 1, and bounds none that is longer', function()
    for name, entry in pairs(all) do
        local f, h, slow = entry[1], 1e-6, 0
        for _ = 1, 1000 do
            local p, square = point(1.3), 0
            for k = 1, 3 do
                local a, b = { p.x, p.y, p.z }, { p.x, p.y, p.z }
                a[k], b[k] = a[k] - h, b[k] + h
                square = square + ((f(b) - f(a)) / (2 * h)) ^ 2
            end
            local largest = name == 'gyroid' and 1.16 or 1
            if name ~= 'twist' and name ~= 'bend' then assert(square < largest ^ 2 + 1e-6, name) end
            if square < 1 - 1e-6 then slow = slow + 1 end
        end
        if entry[2] then assert(slow <= 30, ('%s: %d of 1000 gradients are short'):format(name, slow)) end
    end
end)

claims.claim('distances are those of the textbook', function()
    local f = sdf.box { 1, 2, 3 }
    near(f { 4, 6, 0 }, 5, 1e-12, 'from an edge')
    near(f { 0, 0, 0 }, -1, 0, 'inside')
    near(f { 2, 3, 4 }, math.sqrt(3), 1e-12, 'from a corner')
    near(sdf.torus(2, 0.5) { 2, 0, 0 }, -0.5, 1e-12, 'in the tube')
    near(sdf.torus(2, 0.5) { 0, 0, 0 }, 1.5, 1e-12, 'in the hole')
    near(sdf.cylinder(1, 2) { 4, 6, 0 }, 5, 1e-12, 'from the rim')
    near(sdf.capsule({ 0, 0, 0 }, { 0, 4, 0 }, 1) { 3, 2, 0 }, 2, 1e-12, 'beside')
    near(sdf.capsule({ 0, 0, 0 }, { 0, 4, 0 }, 1) { 0, 6, 0 }, 1, 1e-12, 'above')
    near(sdf.extrude(sdf.rectangle(1, 2), 3) { 2, 3, 4 }, math.sqrt(3), 1e-12, 'an extruded box')
    near(sdf.revolve(sdf.circle(0.5), 2) { 0, 0, 3 }, 0.5, 1e-12, 'a revolved torus')
    near(sdf.polygon(4, 1) { 1.5, 0 }, 0.5, 1e-12, 'a square')
    near(sdf.rotate(sdf.box { 3, 1, 1 }, 'z', 90) { 0, 3, 0 }, 0, 1e-12, 'a turned box')
    near(sdf.rotate(sdf.translate(sdf.sphere(1), { 2, 0, 0 }), 'z', 90) { 0, 2, 0 }, -1, 1e-12, 'counterclockwise')
    near(sdf.twist(sdf.translate(sdf.sphere(1), { 2, 0, 0 }), 90) { 0, 1, -2 }, 0, 1e-9, 'a twisted ball')
    near(sdf.repeated(sdf.sphere(1), { 4, 0, 0 }) { 40, 0, 0 }, -1, 1e-12, 'a copy')
    near(sdf.repeated(sdf.sphere(1), { 4, 0, 0 }, { 2, 0, 0 }) { 40, 0, 0 }, 31, 1e-12, 'the last copy')
end)

claims.claim('smooth sets agree with sharp ones away from the seam, and are larger at a union', function()
    local a, b = sdf.sphere(0.6), sdf.translate(sdf.sphere(0.5), { 0.7, 0, 0 })
    local sharp, smooth = sdf.union(a, b), sdf.smooth_union(0.2, a, b)
    for _ = 1, 1000 do
        local p = point(1.5)
        local difference = sharp(p) - smooth(p)
        assert(difference >= 0 and difference <= 0.05 + 1e-12)
        if math.abs(a(p) - b(p)) >= 0.2 then assert(difference == 0) end
        near(-sdf.smooth_intersection(0.2, a, b)(p), sdf.smooth_union(0.2, function(q) return -a(q) end, function(q) return -b(q) end)(p), 1e-12,
            'by De Morgan')
    end
end)

claims.claim('wrong arguments are named', function()
    claims.fails('sdf.sphere: radius must be a number above 0, not -1', function() sdf.sphere(-1) end)
    claims.fails('sdf.union: 1 or more solids are needed, not 0', function() sdf.union() end)
    claims.fails('sdf.union: solid 2 must be a function, not a table', function() sdf.union(sdf.sphere(), {}) end)
    claims.fails("sdf.rotate: axis must be 'x' or 'y' or 'z', not 'w'", function() sdf.rotate(sdf.sphere(), 'w', 1) end)
    claims.fails('sdf.capsule: from and to must differ', function() sdf.capsule({ 0, 0, 0 }, { 0, 0, 0 }, 1) end)
end)
