local fractals, meshes = require 'fractals', require 'meshes'
local claims = require 'claims'
local near = claims.near
local grey = gr.material({ .5, .5, .5 }, { 0, 0, 0 }, 1)

claims.claim('a sponge of level n has 20^n cells', function()
    for level = 0, 3 do
        local n, count = math.tointeger(3 ^ level), 0
        for i = 0, n - 1 do
            for j = 0, n - 1 do
                for k = 0, n - 1 do count = count + (fractals.menger_has(level, i, j, k) and 1 or 0) end
            end
        end
        assert(count == 20 ^ level)
    end
end)

claims.claim('the mesh of the sponge is closed, with the area and volume of the formula', function()
    for level = 0, 3 do
        local verts, faces = fractals.menger_mesh(level)
        assert(meshes.is_closed(faces))
        near(meshes.volume(verts, faces), 8 * (20 / 27) ^ level, 1e-9, 'volume')
        -- area of a sponge of edge 1: 2 (20/9)^n + 4 (8/9)^n
        near(meshes.area(verts, faces), 4 * (2 * (20 / 9) ^ level + 4 * (8 / 9) ^ level), 1e-9 * 20 ^ level, 'area')
    end
end)

claims.claim('sierpinski solids have 4^n and 5^n parts and halve their edge', function()
    for level = 0, 4 do
        local verts, faces = fractals.sierpinski_mesh(level, 'tetrahedron')
        assert(#faces == 4 * 4 ^ level and meshes.is_closed(faces))
        near(meshes.volume(verts, faces), 8 / (6 * math.sqrt(2)) / 2 ^ level, 1e-9, 'volume')
        near(meshes.area(verts, faces), 4 * math.sqrt(3), 1e-9, 'area, the same at every level')
        verts, faces = fractals.sierpinski_mesh(level, 'pyramid')
        assert(#faces == 5 * 5 ^ level and meshes.is_closed(faces))
        near(meshes.volume(verts, faces), 4 * math.sqrt(2) / 3 * (5 / 8) ^ level, 1e-9, 'volume')
    end
end)

claims.claim('instances fill the same box as meshes', function()
    for _, kind in ipairs { 'tetrahedron', 'pyramid' } do
        local low, high = fractals.sierpinski(3, grey, kind):bounds()
        local l, h = meshes.bounds((fractals.sierpinski_mesh(3, kind)))
        for k = 1, 3 do
            near(low[k], l[k], 1e-9, kind)
            near(high[k], h[k], 1e-9, kind)
        end
    end
    local low, high = fractals.menger(3, grey):bounds()
    for k = 1, 3 do
        near(low[k], -1, 1e-9, 'sponge')
        near(high[k], 1, 1e-9, 'sponge')
    end
end)

claims.claim('a sphere flake reaches 1 + 2/3 + 2/9 ... along an axis of its seats', function()
    local low, high = fractals.sphere_flake(1, grey):bounds()
    near(high[1], 5 / 3, 1e-9, 'flake')
    near(low[1], -5 / 3, 1e-9, 'flake')
    near(low[2], -1, 1e-9, 'below')
    near(high[2], 4 / 3 * math.sqrt(2 / 3) + 1 / 3, 1e-9, 'above')
end)

claims.claim('the sponge is an operand of csg', function()
    local scene = gr.node 'scene'
    local verts, faces = fractals.menger_mesh(2)
    scene:add_child(gr.intersection('half', gr.mesh(grey, verts, faces), gr.plane { normal = { 1, 1, 1 } }))
    verts, faces = fractals.sierpinski_mesh(2, 'tetrahedron')
    scene:add_child(gr.difference('cut', gr.mesh(grey, verts, faces), gr.nh_box(grey, { 0, 0, 0 }, 2)))
    scene:add_child(fractals.sphere_flake(3, { grey, grey }))
    claims.build(scene)
end)

claims.claim('wrong arguments are named', function()
    claims.fails('fractals.menger: level must be a whole number from 0 to 6, not 7', fractals.menger, 7, grey)
    claims.fails("fractals.sierpinski: kind must be 'tetrahedron' or 'pyramid', not 'cube'", fractals.sierpinski, 1, grey, 'cube')
end)
