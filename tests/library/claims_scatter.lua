local scatter, polyhedra, random = require 'scatter', require 'polyhedra', require 'random'
local claims = require 'claims'
local near = claims.near
local grey = gr.material({ .5, .5, .5 }, { 0, 0, 0 }, 1)

local function nearest(points)
    local least = math.huge
    for i = 1, #points do
        local p = points[i].position or points[i]
        for j = i + 1, #points do
            local q, s = points[j].position or points[j], 0
            for k = 1, #p do s = s + (p[k] - q[k]) ^ 2 end
            least = math.min(least, s)
        end
    end
    return math.sqrt(least)
end

claims.claim('random numbers are those of the reference program', function()
    -- the first outputs of pcg32 with state 42 and stream 54, as printed by its demo
    local dice = random.new(42, 54)
    for _, wanted in ipairs { 0xa15c02b7, 0x7b47f409, 0xba1d3330, 0x83d2f293, 0xbfa4784b, 0xcbed606e } do
        assert(dice:bits() == wanted)
    end
end)

claims.claim('random numbers are spread evenly', function()
    local dice, sum, squares, sides = random.new(3), 0, 0, {}
    for _ = 1, 20000 do
        local x, n = dice:number(), dice:normal(2, 3)
        sum, squares = sum + x, squares + (n - 2) ^ 2
        local face = dice:whole(1, 6)
        sides[face] = (sides[face] or 0) + 1
    end
    near(sum / 20000, 0.5, 0.01, 'mean')
    near(squares / 20000, 9, 0.4, 'variance')
    for face = 1, 6 do near(sides[face], 20000 / 6, 200, 'side') end
    local list = dice:shuffle { 1, 2, 3, 4, 5 }
    table.sort(list)
    for k = 1, 5 do assert(list[k] == k) end
end)

claims.claim('places in a rectangle keep their distance and leave no gap of two radii', function()
    local points = scatter.rectangle(10, 6, 0.5, { seed = 4 })
    assert(nearest(points) >= 0.5 and #points > 0.6 * 60 / 0.25)
    local dice = random.new(1)
    for _ = 1, 500 do
        local x, y, covered = dice:range(0, 10), dice:range(0, 6), false
        for _, p in ipairs(points) do covered = covered or (p[1] - x) ^ 2 + (p[2] - y) ^ 2 < 1 end
        assert(covered)
    end
    for _, p in ipairs(points) do assert(p[1] >= 0 and p[1] <= 10 and p[2] >= 0 and p[2] <= 6) end
end)

claims.claim('places in a box keep their distance', function()
    local points = scatter.box({ 3, 2, 1 }, 0.3)
    assert(nearest(points) >= 0.3 and #points > 100)
end)

claims.claim('places on a ball keep their distance, cover it and lie on it', function()
    local verts, _, faces = polyhedra.geodesic(3)
    local places = scatter.mesh(verts, faces, { radius = 0.2, seed = 2 })
    assert(nearest(places) >= 0.2)
    -- between the densest packing, 2 / sqrt 3 per squared radius, and half of it
    local packing = 2 / math.sqrt(3) * 4 * math.pi / 0.04
    assert(#places < packing and #places > 0.5 * packing)
    local dice = random.new(1)
    for _ = 1, 500 do
        local d, covered = dice:direction(), false
        for _, place in ipairs(places) do
            local p = place.position
            covered = covered or (p[1] - d[1]) ^ 2 + (p[2] - d[2]) ^ 2 + (p[3] - d[3]) ^ 2 < 0.26 ^ 2
        end
        assert(covered, 'a hole')
    end
    for _, place in ipairs(places) do
        local p, n = place.position, place.normal
        near(math.sqrt(p[1] ^ 2 + p[2] ^ 2 + p[3] ^ 2), 0.995, 0.006, 'on the surface')
        assert(p[1] * n[1] + p[2] * n[2] + p[3] * n[3] > 0.97)
    end
end)

claims.claim('elimination leaves as many as asked for, better spread than chance', function()
    local verts, _, faces = polyhedra.geodesic(2)
    local places = scatter.mesh(verts, faces, { count = 200, seed = 7 })
    assert(#places == 200)
    -- the upper bound for sets of 200
    local bound = 2 * math.sqrt(4 * math.pi / (2 * math.sqrt(3) * 200))
    local least = nearest(places)
    assert(least > 0.55 * bound and least <= bound, ('%g of %g'):format(least, bound))
end)

claims.claim('the same seed gives the same places and `where` is obeyed', function()
    local verts, _, faces = polyhedra.geodesic(2)
    local options = { radius = 0.3, seed = 11, where = function(p) return p[2] > 0 end }
    local a, b = scatter.mesh(verts, faces, options), scatter.mesh(verts, faces, options)
    assert(#a == #b and #a > 20)
    for k = 1, #a do
        assert(a[k].position[1] == b[k].position[1] and a[k].position[2] > 0)
    end
    options.radius, options.count = nil, 50
    for _, place in ipairs(scatter.mesh(verts, faces, options)) do assert(place.position[2] > 0) end
end)

claims.claim('nodes stand upright on their place', function()
    local stick = gr.box { min = { -0.01, 0, -0.01 }, max = { 0.01, 1, 0.01 }, material = grey }
    for _, n in ipairs { { 1, 0, 0 }, { 0, 0, 1 }, { 0, -1, 0 }, { 0.6, 0.8, 0 }, { 0, 0.6, -0.8 }, { -0.48, 0.6, 0.64 } } do
        local node = scatter.place({ { position = { 5, 6, 7 }, normal = n } }, stick)
        local low, high = node:bounds()
        for k = 1, 3 do
            local base = ({ 5, 6, 7 })[k]
            near(n[k] > 0 and high[k] or low[k], base + n[k], 0.03, 'tip')
            near(n[k] > 0 and low[k] or high[k], base, 0.03, 'foot')
        end
    end
    claims.build(scatter.place(scatter.rectangle(4, 4, 0.5), { stick, gr.sphere(grey) }, { scale = { 0.1, 0.2 } }))
end)

claims.claim('wrong arguments are named', function()
    local verts, _, faces = polyhedra.geodesic(0)
    claims.fails('scatter.mesh: options must hold either radius or count', scatter.mesh, verts, faces, {})
    claims.fails('scatter.mesh: radius must be a number above 0, not -1', scatter.mesh, verts, faces, { radius = -1 })
    claims.fails('scatter.rectangle: radius is so small', scatter.rectangle, 1, 1, 1e-9)
    claims.fails("scatter.mesh: options.where refuses nearly every place", scatter.mesh, verts, faces,
        { count = 3, where = function() return false end })
end)
