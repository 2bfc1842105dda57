local meshes, polyhedra, archimedean, conway = require 'meshes', require 'polyhedra', require 'archimedean', require 'conway'
local claims = require 'claims'
local near = claims.near

local function edge_lengths(verts, faces)
    local low, high = math.huge, 0
    for _, face in ipairs(faces) do
        for i, a in ipairs(face) do
            local p, q = verts[a + 1], verts[face[i % #face + 1] + 1]
            local d = math.sqrt((p[1] - q[1]) ^ 2 + (p[2] - q[2]) ^ 2 + (p[3] - q[3]) ^ 2)
            low, high = math.min(low, d), math.max(high, d)
        end
    end
    return low, high
end

-- Corners, edges, faces and volume for edges of length 1.
local s2, s5, phi = math.sqrt(2), math.sqrt(5), (1 + math.sqrt(5)) / 2
local regular = {
    tetrahedron = { 4, 6, 4, s2 / 12 }, cube = { 8, 12, 6, 1 }, octahedron = { 6, 12, 8, s2 / 3 },
    dodecahedron = { 20, 30, 12, (15 + 7 * s5) / 4 }, icosahedron = { 12, 30, 20, 5 * (3 + s5) / 12 },
}
local half_regular = {
    ['truncated tetrahedron'] = { 12, 18, 8, 23 * s2 / 12 }, cuboctahedron = { 12, 24, 14, 5 * s2 / 3 },
    ['truncated cube'] = { 24, 36, 14, (21 + 14 * s2) / 3 }, ['truncated octahedron'] = { 24, 36, 14, 8 * s2 },
    rhombicuboctahedron = { 24, 48, 26, (12 + 10 * s2) / 3 }, ['truncated cuboctahedron'] = { 48, 72, 26, 22 + 14 * s2 },
    ['snub cube'] = { 24, 60, 38, 7.889477399975387 }, icosidodecahedron = { 30, 60, 32, (45 + 17 * s5) / 6 },
    ['truncated dodecahedron'] = { 60, 90, 32, 5 * (99 + 47 * s5) / 12 },
    ['truncated icosahedron'] = { 60, 90, 32, (125 + 43 * s5) / 4 },
    rhombicosidodecahedron = { 60, 120, 62, (60 + 29 * s5) / 3 },
    ['truncated icosidodecahedron'] = { 120, 180, 62, 95 + 50 * s5 },
    ['snub dodecahedron'] = { 60, 150, 92, 37.61664996273336 },
}

local function check_solid(name, verts, faces, want)
    local v, e, f = meshes.euler(faces)
    assert(v == want[1] and e == want[2] and f == want[3], ('%s: %d corners, %d edges, %d faces'):format(name, v, e, f))
    assert(v - e + f == 2 and meshes.is_closed(faces), name .. ' is not closed')
    local low, high = edge_lengths(verts, faces)
    near(low, high, 1e-9, name .. ': edges differ')
    near(meshes.volume(verts, faces) / high ^ 3, want[4], 1e-9 * want[4], name .. ': volume')
end

claims.claim('regular solids have the corners, edges, faces and volumes of the textbook', function()
    for name, want in pairs(regular) do
        local verts, faces = polyhedra[name]()
        check_solid(name, verts, faces, want)
    end
end)

claims.claim('archimedean solids have the corners, edges, faces and volumes of the textbook', function()
    assert(#archimedean.names == 13)
    for _, name in ipairs(archimedean.names) do
        local verts, faces = archimedean.solid(name)
        check_solid(name, verts, faces, half_regular[name])
    end
end)

claims.claim('prisms and antiprisms are uniform', function()
    for n = 3, 12 do
        local verts, faces = archimedean.prism(n)
        local low, high = edge_lengths(verts, faces)
        near(low, high, 1e-9, 'prism')
        near(meshes.volume(verts, faces) / high ^ 3, n / (4 * math.tan(math.pi / n)), 1e-9, 'volume of a prism')
        verts, faces = archimedean.antiprism(n)
        low, high = edge_lengths(verts, faces)
        near(low, high, 1e-9, 'antiprism')
        local v, e, f = meshes.euler(faces)
        assert(v == 2 * n and e == 4 * n and f == 2 * n + 2 and meshes.is_closed(faces))
        assert(meshes.volume(verts, faces) > 0)
    end
end)

claims.claim('conway operators keep meshes closed and count as they should', function()
    for name, want in pairs(regular) do
        local v, e, f = want[1], want[2], want[3]
        local verts, faces = polyhedra[name]()
        for word, count in pairs { d = { f, e, v }, k = { v + f, 3 * e, 2 * e }, a = { e, 2 * e, v + f }, t = { 2 * e, 3 * e, v + f },
            j = { v + f, 2 * e, e }, e = { 2 * e, 4 * e, 2 * e + 2 }, dd = { v, e, f }, tk = { 6 * e, 9 * e, v + f + 2 * e } } do
            local nv, nf = conway.apply(word, verts, faces)
            local a, b, c = meshes.euler(nf)
            assert(a == count[1] and b == count[2] and c == count[3], ('%s of %s: %d %d %d'):format(word, name, a, b, c))
            assert(meshes.is_closed(nf) and meshes.volume(nv, nf) > 0, word .. ' of ' .. name)
        end
    end
end)

claims.claim('truncation without a share makes the archimedean solid', function()
    local verts, faces = conway.truncate(polyhedra.icosahedron())
    check_solid('truncated', verts, faces, half_regular['truncated icosahedron'])
    verts, faces = conway.truncate(polyhedra.cube())
    check_solid('truncated', verts, faces, half_regular['truncated cube'])
    verts, faces = conway.ambo(polyhedra.dodecahedron())
    check_solid('ambo', verts, faces, half_regular.icosidodecahedron)
end)

claims.claim('geodesic spheres have 10 4^n + 2 corners and nearly the volume of a ball', function()
    for n = 0, 4 do
        local verts, _, faces = polyhedra.geodesic(n)
        local v, e, f = meshes.euler(faces)
        assert(v == 10 * 4 ^ n + 2 and f == 20 * 4 ^ n and v - e + f == 2)
        if n == 4 then near(meshes.volume(verts, faces), 4 / 3 * math.pi, 0.01, 'ball') end
    end
end)

claims.claim('subdivision keeps the topology and Loop turns an octahedron round', function()
    local verts, faces = polyhedra.octahedron()
    local lv, lf = polyhedra.subdivide(polyhedra.loop, 3, verts, faces)
    assert(#lf == 8 * 4 ^ 3 and meshes.is_closed(lf))
    local v, e, f = meshes.euler(lf)
    assert(v - e + f == 2)
    local low, high = math.huge, 0
    for _, p in ipairs(lv) do
        local r = math.sqrt(p[1] ^ 2 + p[2] ^ 2 + p[3] ^ 2)
        low, high = math.min(low, r), math.max(high, r)
    end
    assert(high / low < 1.25)
    local cv, cf = polyhedra.subdivide(polyhedra.catmull_clark, 2, polyhedra.cube())
    v, e, f = meshes.euler(cf)
    assert(f == 96 and v - e + f == 2 and meshes.is_closed(cf))
    -- the first step moves a corner to 5/9 of its distance, the limit is (9 v + 4 sum of edge points + sum of face
    -- points) / 24 = 1/2 of it (Halstead, Kass, DeRose 1993)
    local p = cv[1]
    near(math.sqrt(p[1] ^ 2 + p[2] ^ 2 + p[3] ^ 2), 1 / 2, 0.01, 'corner of the cube')
end)

claims.claim('the solids are operands of csg', function()
    local grey = gr.material({ .5, .5, .5 }, { 0, 0, 0 }, 1)
    local scene = gr.node 'scene'
    for k, name in ipairs(archimedean.names) do
        local verts, faces = archimedean.solid(name)
        scene:add_child(gr.difference('cut', gr.mesh(grey, verts, faces), gr.nh_box(grey, { 0, 0, 0 }, 2)))
    end
    claims.build(scene)
end)

claims.claim('wrong arguments are named', function()
    claims.fails("archimedean.solid: there is no solid 'cub'; there are truncated tetrahedron", archimedean.solid, 'cub')
    claims.fails('archimedean.prism: n must be a whole number from 3 to 10000, not 2', archimedean.prism, 2)
    claims.fails("conway.apply: there is no operator 'x'", conway.apply, 'x', polyhedra.cube())
    claims.fails('conway.dual: the mesh is not closed', conway.dual, { { 0, 0, 0 }, { 1, 0, 0 }, { 0, 1, 0 } }, { { 0, 1, 2 } })
    claims.fails('meshes.volume: faces[1][2] must be an index from 0 to 0, not 7', meshes.volume, { { 0, 0, 0 } }, { { 0, 7, 0 } })
end)
