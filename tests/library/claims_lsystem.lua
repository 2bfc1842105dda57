local lsystem, meshes = require 'lsystem', require 'meshes'
local claims = require 'claims'
local near = claims.near
local grey = gr.material({ .5, .5, .5 }, { 0, 0, 0 }, 1)

claims.claim('algae grow by the numbers of Fibonacci', function()
    local a, b = 1, 2
    for n = 0, 20 do
        assert(#lsystem.grow('A', { A = 'AB', B = 'A' }, n) == a)
        a, b = b, a + b
    end
end)

claims.claim('letters with numbers grow like letters without', function()
    local word = lsystem.grow('F(1)', { F = function(l) return ('F(%g)+F(%g)'):format(l / 2, l / 2) end }, 3)
    assert(word == 'F(0.125)+F(0.125)+F(0.125)+F(0.125)+F(0.125)+F(0.125)+F(0.125)+F(0.125)')
end)

claims.claim('chance follows weights and the seed', function()
    local rules = { X = { { 3, 'a' }, { 1, 'b' } } }
    local word = lsystem.grow(('X'):rep(4000), rules, 1, { seed = 5 })
    local _, count = word:gsub('a', '')
    near(count, 3000, 120, 'share of a')
    assert(word == lsystem.grow(('X'):rep(4000), rules, 1, { seed = 5 }))
    assert(word ~= lsystem.grow(('X'):rep(4000), rules, 1, { seed = 6 }))
end)

claims.claim('the curve of Hilbert visits every place of a cube of 2^n once, in 8^n - 1 steps', function()
    for n = 1, 4 do
        local walk = lsystem.example('hilbert', n)
        local points, seen, count = walk.branches[1].points, {}, 0
        assert(#walk.branches == 1 and walk.steps == 8 ^ n - 1 and #points == 8 ^ n)
        for _, p in ipairs(points) do
            local key = ('%.0f %.0f %.0f'):format(p[1] - walk.low[1], p[2] - walk.low[2], p[3] - walk.low[3]):gsub('%-0', '0')
            if not seen[key] then seen[key], count = true, count + 1 end
        end
        assert(count == 8 ^ n)
        for k = 1, 3 do near(walk.high[k] - walk.low[k], 2 ^ n - 1, 1e-9, 'side') end
    end
end)

claims.claim("koch's snowflake closes after 3 4^n steps and its box has the known size", function()
    local walk = lsystem.example('koch', 4, { length = 3 ^ -4 })
    local p = walk.branches[1].points
    assert(walk.steps == 3 * 4 ^ 4)
    near(p[#p][1] - p[1][1], 0, 1e-9, 'x')
    near(p[#p][2] - p[1][2], 0, 1e-9, 'y')
    near((walk.high[1] - walk.low[1]) / (walk.high[2] - walk.low[2]), 2 / math.sqrt(3), 1e-9, 'sides of the box')
end)

claims.claim('turning goes as the book says', function()
    local function finish(word, wanted)
        local p = lsystem.walk(word .. 'F').branches
        local last = p[#p].points
        local a, b = last[#last - 1], last[#last]
        for k = 1, 3 do near(b[k] - a[k], wanted[k], 1e-12, word) end
    end
    finish('', { 0, 1, 0 })
    finish('++', { 0, -1, 0 })
    finish('|', { 0, -1, 0 })
    finish('+-', { 0, 1, 0 })
    finish('&^', { 0, 1, 0 })
    finish('+(30)-(30)', { 0, 1, 0 })
    finish('F[+F&F]', { 0, 1, 0 })
    -- left, then seen from the new heading: a roll does not change it
    local left = lsystem.walk('+F').branches[1].points[2]
    finish('+/', left)
    finish('-', { -left[1], -left[2], -left[3] })
    -- pitching up after a roll of 90 degrees to the left is a turn to the right
    finish('\\^', { -left[1], -left[2], -left[3] })
end)

claims.claim('tropism bends down', function()
    local walk = lsystem.walk(('F'):rep(200), { heading = { 1, 0, 0 }, tropism = { { 0, -1, 0 }, 0.1 } })
    local p = walk.branches[1].points
    near(p[#p][2] - p[#p - 1][2], -1, 1e-3, 'last step')
end)

claims.claim('branches, leaves and polygons are counted', function()
    local walk = lsystem.walk('F[+F~][-F~(2)]F{.f.+f.+f.}', {})
    assert(#walk.branches == 3 and #walk.leaves == 2 and #walk.polygons == 1 and #walk.polygons[1].points == 4)
    assert(walk.leaves[1].size == 1 and walk.leaves[2].size == 2)
end)

claims.claim('a branch is a closed tube with the volume of its frusta', function()
    local walk = lsystem.walk('F!(0.1)F!(0.05)F', { radius = 0.2 })
    local verts, _, faces = lsystem.mesh(walk, { around = 64, round = false })
    assert(meshes.is_closed(faces))
    local v, e, f = meshes.euler(faces)
    assert(v - e + f == 2)
    local wanted, r = 0, { 0.2, 0.2, 0.1, 0.05 }
    for k = 1, 3 do wanted = wanted + math.pi / 3 * (r[k] ^ 2 + r[k] * r[k + 1] + r[k + 1] ^ 2) end
    near(meshes.volume(verts, faces), wanted, 0.005 * wanted, 'volume')
end)

claims.claim('trees are built', function()
    local walk = lsystem.example('tree', 5)
    assert(#walk.branches > 10)
    local scene = gr.node 'scene'
    local verts, normals, faces, face_normals = lsystem.mesh(walk, { around = 5, smooth = 2 })
    scene:add_child(gr.vn_mesh(grey, verts, normals, faces, face_normals))
    scene:add_child(lsystem.sweeps(lsystem.example('hilbert', 1), grey))
    scene:add_child(gr.vn_mesh(grey, lsystem.leaves(lsystem.example('bush', 2))))
    claims.build(scene)
end)

claims.claim('wrong arguments are named', function()
    claims.fails('lsystem.grow: the word grows beyond 1000 letters', lsystem.grow, 'A', { A = 'AA' }, 100, { limit = 1000 })
    claims.fails('lsystem.grow: the word grows beyond 1000 letters', lsystem.grow, 'A(1)', { A = 'A(1)A(1)' }, 100, { limit = 1000 })
    claims.fails("lsystem.walk: 'x' is not a number at letter 1", lsystem.walk, 'F(x)')
    claims.fails('lsystem.walk: there is a ] without [', lsystem.walk, 'F]')
    claims.fails('lsystem.walk: 2 of the [ have no ]', lsystem.walk, 'F[[')
    claims.fails("lsystem.grow: rules are for single letters, not for 'AB'", lsystem.grow, 'A', { AB = 'A' }, 1)
end)
