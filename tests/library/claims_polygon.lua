local polygon, meshes, random = require 'polygon', require 'meshes', require 'random'
local claims = require 'claims'
local near = claims.near
local grey = gr.material({ .5, .5, .5 }, { 0, 0, 0 }, 1)

local function ring(n, radius, x, y, wobble, dice)
    local out = {}
    for k = 0, n - 1 do
        local r = radius * (1 + (wobble and dice:range(-wobble, wobble) or 0))
        out[k + 1] = { x + r * math.cos(2 * math.pi * k / n), y + r * math.sin(2 * math.pi * k / n) }
    end
    return out
end

local function area_of(points, triangles)
    local sum = 0
    for _, t in ipairs(triangles) do
        local a = polygon.area { points[t[1] + 1], points[t[2] + 1], points[t[3] + 1] }
        assert(a >= -1e-12, 'a triangle is turned over')
        sum = sum + a
    end
    return sum
end

claims.claim('triangles of random stars with random holes fill their area, n + 2 h - 2 of them', function()
    local dice = random.new(5)
    for round = 1, 60 do
        local outlines, area, n = { ring(dice:whole(5, 40), 10, 0, 0, 0.3, dice) }, 0, 0
        local holes = dice:whole(0, 6)
        for h = 1, holes do
            local a = 2 * math.pi * h / holes
            outlines[h + 1] = ring(dice:whole(3, 12), 1.6, 4 * math.cos(a), 4 * math.sin(a), 0.25, dice)
        end
        for k, outline in ipairs(outlines) do
            area, n = area + (k == 1 and 1 or -1) * math.abs(polygon.area(outline)), n + #outline
        end
        local points, triangles = polygon.triangulate(outlines)
        near(area_of(points, triangles), area, 1e-9 * area, 'area in round ' .. round)
        assert(#triangles == n + 2 * holes - 2, ('%d triangles in round %d'):format(#triangles, round))
    end
end)

claims.claim('islands in lakes are filled, whichever way outlines run', function()
    local outlines = { ring(20, 4, 0, 0), ring(12, 3, 0, 0), ring(9, 2, 0, 0), ring(7, 1, 0, 0), ring(8, 1, 9, 0) }
    local back = {}
    for k, p in ipairs(outlines[1]) do back[#outlines[1] + 1 - k] = p end
    outlines[1] = back
    local wanted = 0
    for k, outline in ipairs(outlines) do wanted = wanted + math.abs(polygon.area(outline)) * (k == 2 and -1 or k == 4 and -1 or 1) end
    near(area_of(polygon.triangulate(outlines)), wanted, 1e-9, 'area')
    assert(#polygon.bodies(outlines) == 3)
end)

claims.claim('squares and circles grow by an offset as they should', function()
    near(polygon.area(polygon.offset({ { 0, 0 }, { 2, 0 }, { 2, 2 }, { 0, 2 } }, 0.5)), 9, 1e-12, 'square')
    near(polygon.area(polygon.offset({ { 0, 0 }, { 2, 0 }, { 2, 2 }, { 0, 2 } }, -0.5)), 1, 1e-12, 'square')
    near(polygon.area(polygon.offset(ring(200, 1, 0, 0), 0.25)) / math.pi, 1.25 ^ 2, 1e-3, 'circle')
end)

claims.claim('drawn out solids are closed with the volume of area times depth, less the bevel', function()
    local square, hole = { { 0, 0 }, { 4, 0 }, { 4, 4 }, { 0, 4 } }, { { 1, 1 }, { 1, 3 }, { 3, 3 }, { 3, 1 } }
    local verts, _, faces = polygon.extrude({ square, hole }, 0.5)
    assert(meshes.is_closed(faces))
    near(meshes.volume(verts, faces), 12 * 0.5, 1e-9, 'volume')
    local v, e, f = meshes.euler(faces)
    assert(v - e + f == 0)
    for _, options in ipairs { { bevel = 0.1 }, { bevel = 0.1, back = true }, { bevel = 0.1, steps = 4 }, { bevel = 0.2, steps = 3, back = true } } do
        verts, _, faces = polygon.extrude({ square }, 0.5, options)
        assert(meshes.is_closed(faces))
        local volume = meshes.volume(verts, faces)
        assert(volume < 8 and volume > 8 - 16 * 0.04)
        local low, high = meshes.bounds(verts)
        near(low[3], 0, 1e-12, 'back')
        near(high[3], 0.5, 1e-12, 'front')
    end
    verts, _, faces = polygon.extrude({ square }, 0.5, { bevel = 0.1 })
    -- a frustum of height 0.1 between squares of 4 and 3.8
    near(meshes.volume(verts, faces), 16 * 0.4 + 0.1 / 3 * (16 + 4 * 3.8 + 3.8 ^ 2), 1e-9, 'flat bevel')
    local mesh = { polygon.extrude({ square, hole }, 1, { bevel = 0.1 }) }
    claims.build(gr.difference('cut', gr.vn_mesh(grey, table.unpack(mesh)), gr.sphere(grey)))
end)

claims.claim('wrong arguments are named', function()
    claims.fails('polygon.area: outline must have at least 3 entries, not 2', polygon.area, { { 0, 0 }, { 1, 1 } })
    claims.fails('polygon.extrude: depth must be a number above 0, not 0', polygon.extrude, { { { 0, 0 }, { 1, 0 }, { 0, 1 } } }, 0)
end)
