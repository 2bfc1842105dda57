local bezier, lathe, sweep, knot, loft, meshes = require 'bezier', require 'lathe', require 'sweep', require 'knot', require 'loft', require 'meshes'
local claims = require 'claims'
local near = claims.near
local grey = gr.material({ .5, .5, .5 }, { 0, 0, 0 }, 1)
local pi = math.pi

local function net(columns, rows, f)
    local out = {}
    for j = 1, rows do
        out[j] = {}
        for i = 1, columns do out[j][i] = f(i - 1, j - 1) end
    end
    return out
end

local function patch_at(control, patches, k, u, v)
    local c = {}
    for i = 1, 16 do c[i] = control[patches[k][i] + 1] end
    return bezier.eval(c, u, v)
end

claims.claim('spline surfaces over a plane net are that plane and keep straight lines', function()
    local plane = net(6, 5, function(i, j) return { i, 2 * i - 3 * j + 1, j } end)
    for _, make in ipairs { bezier.b_spline, bezier.through } do
        local control, patches = make(plane)
        assert(#patches == (make == bezier.through and 5 * 4 or 3 * 2))
        for k = 1, #patches do
            local p = patch_at(control, patches, k, 0.3, 0.7)
            near(p[2], 2 * p[1] - 3 * p[3] + 1, 1e-12, 'plane')
        end
    end
end)

claims.claim('a surface through points goes through them and joins smoothly', function()
    local bumps = net(5, 4, function(i, j) return { i, math.sin(2 * i + j * j), j } end)
    local control, patches = bezier.through(bumps)
    for j = 0, 2 do
        for i = 0, 3 do
            local k = j * 4 + i + 1
            for v = 0, 1 do
                for u = 0, 1 do
                    near(patch_at(control, patches, k, u, v)[2], bumps[j + v + 1][i + u + 1][2], 1e-12, 'corner')
                end
            end
            if i < 3 then
                local _, left = patch_at(control, patches, k, 1, 0.4)
                local _, right = patch_at(control, patches, k + 1, 0, 0.4)
                for d = 1, 3 do near(left[d], right[d], 1e-12, 'derivative') end
            end
        end
    end
end)

claims.claim('a b-spline is the mean (1, 4, 1) / 6 of its net at a knot, in both directions', function()
    local spike = net(5, 5, function(i, j) return { i, i == 2 and j == 2 and 36 or 0, j } end)
    local control, patches = bezier.b_spline(spike)
    near(patch_at(control, patches, 1, 1, 1)[2], 16, 1e-12, 'middle')
    near(patch_at(control, patches, 1, 0, 1)[2], 4, 1e-12, 'beside')
    near(patch_at(control, patches, 1, 0, 0)[2], 1, 1e-12, 'corner')
end)

claims.claim('a surface closed both ways is a closed mesh after welding', function()
    local ring = net(8, 6, function(i, j)
        local a, b = 2 * pi * i / 8, 2 * pi * j / 6
        return { (2 + math.cos(b)) * math.cos(a), math.sin(b), (2 + math.cos(b)) * math.sin(a) }
    end)
    for _, make in ipairs { bezier.b_spline, bezier.through } do
        local control, patches = make(ring, true, true)
        assert(#patches == 48)
        local verts, _, faces = bezier.mesh(control, patches, 4)
        verts, faces = meshes.weld(verts, faces)
        assert(meshes.is_closed(faces))
        local v, e, f = meshes.euler(faces)
        assert(v - e + f == 0)
        near(math.abs(meshes.volume(verts, faces)), 2 * pi * pi * 2, 2 * pi * pi * 2 * 0.45, 'volume of a torus, about')
    end
end)

claims.claim('a turned profile has the volume of its frusta', function()
    local verts, _, faces = lathe.turn({ { 0, 0 }, { 1, 0 }, { 0.5, 2 }, { 0, 2 } }, 200)
    assert(meshes.is_closed(faces))
    near(meshes.volume(verts, faces), pi * 2 / 3 * (1 + 0.5 + 0.25), 0.002, 'volume')
    -- Pappus: a ring of a small square
    local square = {}
    for _, p in ipairs { { 2, 0 }, { 2.2, 0 }, { 2.2, 0.2 }, { 2, 0.2 }, { 2, 0 } } do square[#square + 1] = p end
    verts, _, faces = lathe.turn(square, 300)
    near(meshes.volume(verts, faces), 2 * pi * 2.1 * 0.04, 1e-3, 'ring')
end)

claims.claim('tubes along a straight path are prisms and closed ones are rings', function()
    local verts, _, faces = sweep.tube({ { 0, 0, 0 }, { 0, 0, 1 }, { 0, 0, 3 } }, 0.5, 6)
    assert(meshes.is_closed(faces))
    near(meshes.volume(verts, faces), 3 * 6 * 0.25 * math.sin(pi / 6) * math.cos(pi / 6), 1e-9, 'volume')
    local v, e, f = meshes.euler(faces)
    assert(v - e + f == 2)
end)

claims.claim('frames are orthonormal, follow the path and come back to themselves on a ring', function()
    local path = knot.curve(2, 3, 120)
    local frames = sweep.frames(path, true)
    local function dot(a, b) return a[1] * b[1] + a[2] * b[2] + a[3] * b[3] end
    for k, frame in ipairs(frames) do
        for i = 1, 3 do
            for j = 1, 3 do near(dot(frame[i], frame[j]), i == j and 1 or 0, 1e-9, 'frame') end
        end
        local next_frame = frames[k % #frames + 1]
        assert(dot(frame[2], next_frame[2]) > 0.9, 'the frames jump')
    end
end)

claims.claim('knots are closed rings of the volume that their length gives', function()
    for _, name in ipairs { 'trefoil', 'figure eight', 'cinquefoil', 'three twist', 'septafoil', 'granny' } do
        local path, length = knot.named(name, 200), 0
        for k, p in ipairs(path) do
            local q = path[k % #path + 1]
            length = length + math.sqrt((p[1] - q[1]) ^ 2 + (p[2] - q[2]) ^ 2 + (p[3] - q[3]) ^ 2)
        end
        local verts, _, faces = knot.tube(path, 0.03, 8)
        assert(meshes.is_closed(faces), name)
        local v, e, f = meshes.euler(faces)
        assert(v - e + f == 0)
        near(meshes.volume(verts, faces), length * 0.03 ^ 2 * 8 / 2 * math.sin(2 * pi / 8), 0.02 * length * 0.03 ^ 2 * pi, name)
    end
end)

claims.claim('the trefoil winds twice round the axis and three times through the hole', function()
    local path, round, through = knot.curve(2, 3, 600), 0, 0
    for k, p in ipairs(path) do
        local q = path[k % #path + 1]
        local a = math.atan(q[3], q[1]) - math.atan(p[3], p[1])
        round = round + (a > pi and a - 2 * pi or a < -pi and a + 2 * pi or a)
        local u, w = { math.sqrt(p[1] ^ 2 + p[3] ^ 2) - 1, p[2] }, { math.sqrt(q[1] ^ 2 + q[3] ^ 2) - 1, q[2] }
        local b = math.atan(w[2], w[1]) - math.atan(u[2], u[1])
        through = through + (b > pi and b - 2 * pi or b < -pi and b + 2 * pi or b)
    end
    near(round / (2 * pi), 2, 1e-9, 'round')
    near(through / (2 * pi), 3, 1e-9, 'through')
end)

claims.claim('a loft between equal squares is a box, between squares a frustum', function()
    local square = { { -1, 1 }, { 1, 1 }, { 1, -1 }, { -1, -1 } }
    local small = { { -0.5, 0.5 }, { 0.5, 0.5 }, { 0.5, -0.5 }, { -0.5, -0.5 } }
    local verts, _, faces = loft.mesh({ square, square }, { heights = { 0, 3 }, around = 16 })
    assert(meshes.is_closed(faces))
    near(meshes.volume(verts, faces), 12, 1e-9, 'box')
    verts, _, faces = loft.mesh({ square, small }, { heights = { 0, 3 }, around = 16, straight = true })
    near(meshes.volume(verts, faces), 3 / 3 * (4 + 2 + 1), 1e-9, 'frustum')
end)

claims.claim('a loft goes through its sections and does not twist', function()
    -- the same circle with different start points
    local sections = {}
    for k = 1, 4 do sections[k] = loft.polygon(40, 1, nil, 90 * k) end
    local verts, _, faces = loft.mesh(sections, { heights = { 0, 1, 2, 3 }, around = 40 })
    near(meshes.volume(verts, faces), 3 * 20 * math.sin(2 * pi / 40), 1e-6, 'volume')
    local ring = {}
    for k = 0, 11 do
        local a, section = 2 * pi * k / 12, {}
        for i = 0, 23 do
            local b = 2 * pi * i / 24
            section[i + 1] = { (3 + math.cos(b)) * math.cos(a), math.sin(b), -(3 + math.cos(b)) * math.sin(a) }
        end
        ring[k + 1] = section
    end
    verts, _, faces = loft.mesh(ring, { ring = true, around = 24 })
    assert(meshes.is_closed(faces))
    near(math.abs(meshes.volume(verts, faces)), 2 * pi * pi * 3, 0.03 * 2 * pi * pi * 3, 'torus')
end)

claims.claim('resampled outlines keep to the outline at equal steps', function()
    local points = loft.resample({ { 0, 0 }, { 4, 0 }, { 4, 4 }, { 0, 4 } }, 16)
    for k, p in ipairs(points) do
        local q = points[k % 16 + 1]
        near(math.abs(p[1] - q[1]) + math.abs(p[2] - q[2]), 1, 1e-12, 'step')
    end
    near(loft.resample({ { 0, 0 }, { 4, 0 }, { 4, 4 }, { 0, 4 } }, 4, 0.125)[1][1], 2, 1e-12, 'start')
end)

claims.claim('they are operands of csg', function()
    local scene = gr.node 'scene'
    local knife = gr.nh_box(grey, { 0, 0, 0 }, 9)
    for _, mesh in ipairs {
        { knot.mesh(2, 3, { n = 60, around = 6 }) },
        { loft.mesh({ loft.polygon(5, 1, 0.5), loft.superellipse(1, 1, 4) }, { heights = { 0, 1 } }) },
        { lathe.turn({ { 0, 0 }, { 1, 0 }, { 0, 1 } }) },
    } do scene:add_child(gr.difference('cut', gr.vn_mesh(grey, table.unpack(mesh)), knife)) end
    claims.build(scene)
end)

claims.claim('wrong arguments are named', function()
    claims.fails('knot.mesh: p and q must have no common divisor; 2 and 4 have 2', knot.mesh, 2, 4)
    claims.fails("knot.named: there is no knot 'bow'", knot.named, 'bow')
    claims.fails('loft.mesh: sections must have at least 2 entries, not 1', loft.mesh, { {} })
    claims.fails('bezier.through: net[2] must have 2 points', bezier.through, { { { 0, 0, 0 }, { 1, 0, 0 } }, { { 0, 0, 0 }, { 1, 0, 0 }, { 2, 0, 0 } } })
    claims.fails('lathe.turn: profile[2][1] must be a number, not nothing', lathe.turn, { { 0, 0 }, {} })
    claims.fails('sweep.tube: radius must be a number above 0, not nothing', sweep.tube, { { 0, 0, 0 }, { 1, 0, 0 } })
    claims.fails('sweep.profile: there is no option size', sweep.profile, { { 0, 0, 0 }, { 1, 0, 0 } }, { { 0, 0 }, { 1, 0 }, { 0, 1 } }, { size = 3 })
end)
