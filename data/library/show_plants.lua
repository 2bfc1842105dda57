-- TITLE: Library: what words grow into
-- L-systems: two trees after Honda, a bush and herbs from "The Algorithmic Beauty of Plants", and flowers from a word
-- of gray's own with random rules.
-- Author: gray project

local studio = require 'studio'
local colour, lsystem, random, scatter = require 'colour', require 'lsystem', require 'random', require 'scatter'

local scene, dice = gr.node 'plants', random.new(12)
local bark = studio.matt { 0.30, 0.20, 0.13 }
local function leafy(c) return gr.material { kd = c, ks = { 0.15, 0.15, 0.12 }, shininess = 20, two_sided = true } end

local function put(node, x, z, size, turn, y)
    local sized, turned, placed = gr.node 'sized', gr.node 'turned', gr.node 'placed'
    sized:scale(size, size, size)
    sized:add_child(node)
    turned:rotate('y', turn)
    turned:add_child(sized)
    placed:translate(x, y or 0, z)
    placed:add_child(turned)
    scene:add_child(placed)
end

--- Leaves are translucent: they are shaded by their position in the crown, not individually.
local function foliage(c, walk, leaf)
    local verts, _, faces = lsystem.leaves(walk, leaf)
    local normals, middle = {}, { 0, walk.high[2] * 0.45, 0 }
    for k, p in ipairs(verts) do
        local x, y, z = p[1] - middle[1], p[2] - middle[2], p[3] - middle[3]
        local length = math.sqrt(x * x + y * y + z * z)
        normals[k] = { x / length - 0.25 + dice:range(-0.3, 0.3), y / length + 0.35, z / length + 0.4 + dice:range(-0.3, 0.3) }
    end
    return gr.vn_mesh(leafy(c), verts, normals, faces, faces)
end

--- A tree whose last twigs carry leaves.
local function tree(ratio, angles, leaves, seed)
    local rules = {
        A = function(l, w)
            return ('!(%.5g)F(%.5g)[&(%g)B(%.5g,%.5g)]/(137.5)A(%.5g,%.5g)'):format(w, l, angles[1], l * ratio, w * 0.707, l * 0.9, w * 0.707)
        end,
        B = function(l, w)
            return ('!(%.5g)F(%.5g)[-(%g)$C(%.5g,%.5g)]C(%.5g,%.5g)'):format(w, l, angles[2], l * ratio, w * 0.707, l * 0.9, w * 0.707)
        end,
        C = function(l, w)
            return ('!(%.5g)F(%.5g)[+(%g)$B(%.5g,%.5g)]B(%.5g,%.5g)'):format(w, l, angles[2], l * ratio, w * 0.707, l * 0.9, w * 0.707)
        end,
    }
    local word = lsystem.grow('!(0.09)F(0.5)A(1,0.09)', rules, quick and 4 or 9)
    word = word:gsub('[ABC]%b()', '[&(50)~][/(120)&(60)~][/(240)&(50)~][/(60)&(20)~]')
    local walk = lsystem.walk(word, { leaf = 0.34, jitter = 9, seed = seed, tropism = { { 0, -1, 0 }, 0.06 } })
    local node = gr.node 'tree'
    node:add_child(gr.vn_mesh(bark, lsystem.mesh(walk, { around = 7, smooth = 2 })))
    node:add_child(foliage(leaves, walk))
    return node
end
put(tree(0.68, { 45, 45 }, { 0.30, 0.52, 0.15 }, 2), -4.0, -1.2, 0.70, 20)
put(tree(0.78, { 32, 50 }, { 0.80, 0.40, 0.10 }, 7), 4.2, -1.5, 0.60, 80)

-- The book's bush.
local bush = lsystem.example('bush', 6, { length = 0.11, radius = 0.03, thinner = 0.85, leaf = 0.2 })
local shrub = gr.node 'bush'
shrub:add_child(gr.vn_mesh(bark, lsystem.mesh(bush, { around = 5 })))
shrub:add_child(foliage({ 0.20, 0.44, 0.24 }, bush))
put(shrub, 0.2, -1.4, 1.0, 0)

--- Normals between the directions to the light and to the camera.
local function bright(verts)
    local out = {}
    for k = 1, #verts do out[k] = { -0.3 + dice:range(-0.2, 0.2), 0.8, 0.6 } end
    return out
end

-- Flowers: a randomly bent stem with leaves, and a head of petals around a ball.
local function flower(seed, petal)
    local rules = { S = { { 2, 'F+(6)/(30)S' }, { 2, 'F-(6)\\(40)S' }, { 1, 'F[&(50);(1)~(0.5)]/(100)[&(60);(1)~(0.4)]S' } } }
    local word = lsystem.grow('F[&(55)~(0.6)]/(160)[&(60)~(0.5)]S', rules, 7, { seed = seed }):gsub('S$', 'F')
    local petals = {}
    for k = 0, 12 do petals[#petals + 1] = ('[/(%.4g)&(%g);(2)~(0.52)]'):format(k * 360 / 13, k % 2 == 0 and 78 or 68) end
    local walk = lsystem.walk(word .. table.concat(petals) .. ';(3)~(1)', { length = 0.2, radius = 0.022, leaf = 0.4 })
    local node = gr.node 'flower'
    local green = leafy { 0.24, 0.46, 0.12 }
    node:add_child(gr.vn_mesh(green, lsystem.mesh(walk, { around = 6, smooth = 4 })))
    node:add_child(gr.vn_mesh(green, lsystem.leaves(walk, lsystem.blade(0.35), 1)))
    local verts, _, faces = lsystem.leaves(walk, lsystem.blade(0.5), 2)
    node:add_child(gr.vn_mesh(leafy(petal), verts, bright(verts), faces, faces))
    local head = walk.leaves[#walk.leaves].position
    node:add_child(gr.ellipsoid { centre = head, radii = { 0.12, 0.07, 0.12 }, material = studio.matt { 0.72, 0.48, 0.05 } })
    return node
end
for k = 1, 9 do
    local petal = colour.palette({ { 0.93, 0.90, 0.86 }, { 0.90, 0.62, 0.70 }, { 0.62, 0.38, 0.72 } }, (k * 0.37) % 1)
    put(flower(20 + k, petal), -2.3 + 0.55 * k + dice:range(-0.1, 0.1), 1.5 + dice:range(-0.5, 0.7), dice:range(0.62, 0.86), dice:range(0, 360))
end

-- Herbs of one plane, in tufts.
local herb = gr.vn_mesh(leafy { 0.42, 0.52, 0.16 }, lsystem.mesh(lsystem.example('herb', 4, { length = 0.028, radius = 0.008 }), { around = 4 }))
for _, p in ipairs { { -2.6, 0.9 }, { -3.3, 1.5 }, { 3.4, 1.2 }, { 2.9, 1.9 }, { -5.6, 0.6 }, { 5.9, 0.8 } } do
    for turn = 0, 2 do put(herb, p[1], p[2], dice:range(0.75, 1), dice:range(0, 60) + 60 * turn) end
end

studio.render {
    node = scene, file = 'show_plants.png', eye = { 0, 3.2, 15 }, target = { 0, 1.9, 0 }, fov = 24, floor = { 0.50, 0.47, 0.38 },
    key = { -15, 9, 6 }, lamp = 1.4, light = { 2.1, 1.6, 0.95 }, sky = { 0.28, 0.36, 0.50 },
}
