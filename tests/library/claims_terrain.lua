local terrain, meshes = require 'terrain', require 'meshes'
local claims = require 'claims'
local near = claims.near
local grey = gr.material({ .5, .5, .5 }, { 0, 0, 0 }, 1)

local function sum(heights)
    local s = 0
    for _, row in ipairs(heights) do
        for _, h in ipairs(row) do s = s + h end
    end
    return s
end

local function same(a, b)
    if #a ~= #b or #a[1] ~= #b[1] then return false end
    for j = 1, #a do
        for i = 1, #a[1] do
            if a[j][i] ~= b[j][i] then return false end
        end
    end
    return true
end

claims.claim('midpoint displacement keeps its corners and has 2^n + 1 rows', function()
    local h = terrain.midpoint { level = 5, seed = 3, corners = { 1, 2, 3, 4 } }
    assert(#h == 33 and #h[1] == 33)
    assert(h[1][1] == 1 and h[1][33] == 2 and h[33][1] == 3 and h[33][33] == 4)
    assert(same(h, terrain.midpoint { level = 5, seed = 3, corners = { 1, 2, 3, 4 } }))
    assert(not same(h, terrain.midpoint { level = 5, seed = 4, corners = { 1, 2, 3, 4 } }))
end)

claims.claim('midpoint displacement without roughness is interpolation after its first step', function()
    local h = terrain.midpoint { level = 4, roughness = 0, corners = { 0, 0, 0, 0 } }
    for j = 1, 17 do
        for i = 1, 17 do assert(math.abs(h[j][i]) <= 2) end
    end
    near(h[5][5], (h[1][1] + h[1][9] + h[9][1] + h[9][9]) / 4, 1e-12, 'middle')
end)

claims.claim('rough land is rougher', function()
    local function roughness(h)
        local s = 0
        for j = 1, #h do
            for i = 2, #h[1] do s = s + (h[j][i] - h[j][i - 1]) ^ 2 end
        end
        return s
    end
    assert(roughness(terrain.midpoint { roughness = 0.7 }) > 4 * roughness(terrain.midpoint { roughness = 0.4 }))
    assert(roughness(terrain.noise { octaves = 6 }) > roughness(terrain.noise { octaves = 1 }))
end)

claims.claim('noise depends on its seed and nothing else', function()
    local options = { columns = 20, rows = 12, warp = 0.3, ridged = true, seed = 9 }
    local h = terrain.noise(options)
    assert(#h == 12 and #h[1] == 20 and same(h, terrain.noise(options)))
    options.seed = 10
    assert(not same(h, terrain.noise(options)))
end)

claims.claim('fit reaches both ends', function()
    local low, high = terrain.range(terrain.fit(terrain.noise { columns = 30, rows = 30 }, -2, 5))
    near(low, -2, 1e-12, 'low')
    near(high, 5, 1e-12, 'high')
end)

claims.claim('slopes come to rest, keep their mass and lie at the talus', function()
    local pile = terrain.of(21, 21, function(_, _, i, j) return i == 11 and j == 11 and 4 or 0 end)
    local rest = terrain.erode_slopes(pile, { steps = 400, talus = 0.1 })
    near(sum(rest), 4, 1e-9, 'mass')
    local steepest = 0
    for j = 1, 21 do
        for i = 2, 21 do steepest = math.max(steepest, math.abs(rest[j][i] - rest[j][i - 1])) end
    end
    assert(steepest < 0.101 and rest[11][11] < 1)
    near(rest[9][11], rest[11][9], 1e-12, 'symmetry')
end)

claims.claim('rain digs valleys and never more than the land has', function()
    local land = terrain.noise { columns = 48, rows = 48, octaves = 4, seed = 2 }
    local wet = terrain.erode_rain(land, { drops = 3000 })
    local low, high = terrain.range(land)
    local l, h = terrain.range(wet)
    assert(not same(land, wet) and h <= high + 1e-9 and l > low - 0.2 * (high - low))
    assert(sum(wet) <= sum(land) + 1e-6, 'soil that drops carry away is lost, none is made')
    assert(same(wet, terrain.erode_rain(land, { drops = 3000 })) and same(land, terrain.erode_rain(land, { drops = 0, scale = 1 })))
end)

claims.claim('heights between points are bilinear', function()
    local h = terrain.of(9, 5, function(u, v) return 2 * u - 3 * v + u * v end)
    for _, p in ipairs { { 0.3, 0.9 }, { 0, 1 }, { 1, 0 }, { 0.51, 0.49 } } do
        near(terrain.at(h, p[1], p[2]), 2 * p[1] - 3 * p[2] + p[1] * p[2], 1e-12, 'at')
    end
end)

claims.claim('closed land is a solid with the volume under it', function()
    local h = terrain.of(7, 11, function(u, v) return 1 + u + 2 * v end)
    local verts, normals, faces, face_normals = terrain.mesh(h, { width = 3, depth = 2, bottom = 0 })
    assert(meshes.is_closed(faces) and #faces == #face_normals)
    near(meshes.volume(verts, faces), 6 * 2.5, 1e-9, 'volume')
    for k, face in ipairs(faces) do -- every normal is on the front side of its face
        local x, y, z = meshes.face_normal(verts, face)
        local n = normals[face_normals[k][1] + 1]
        assert(x * n[1] + y * n[2] + z * n[3] > 0)
    end
    local node = gr.vn_mesh(grey, verts, normals, faces, face_normals)
    claims.build(gr.intersection('cut', node, gr.sphere(grey)))
end)

claims.claim('split loses no face', function()
    local verts, normals, faces = terrain.mesh(terrain.noise { columns = 20, rows = 20 })
    local groups, count = terrain.split(verts, normals, faces, function(_, y, _, up) return up > 0.9 and 'flat' or y > 0 and 'high' or 'low' end), 0
    for _, mesh in pairs(groups) do count = count + #mesh[3] end
    assert(count == 19 * 19)
end)

claims.claim('wrong arguments are named', function()
    claims.fails('terrain.noise: there is no option colums; the options are columns', terrain.noise, { colums = 3 })
    claims.fails('terrain.midpoint: level must be a whole number from 1 to 10, not 20', terrain.midpoint, { level = 20 })
    claims.fails('terrain.mesh: heights[2] must have 2 numbers', terrain.mesh, { { 1, 2 }, { 1 } })
    claims.fails('terrain.fit: high must be a number of at least 3, not 2', terrain.fit, { { 1, 2 }, { 1, 3 } }, 3, 2)
end)
