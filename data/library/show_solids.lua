-- TITLE: Library: regular and half-regular solids
-- The five Platonic solids in gold, the thirteen Archimedean ones behind them, prisms and antiprisms, and the results
-- of Conway's operators on a dodecahedron.
-- Author: gray project

local studio = require 'studio'
local archimedean, colour, conway, polyhedra = require 'archimedean', require 'colour', require 'conway', require 'polyhedra'

local scene = gr.node 'solids'

--- Puts a solid with its lowest face or corner on the floor.
local function stand(verts, faces, material, x, z, size, turn, y)
    local solid = gr.mesh(material, verts, faces)
    solid:scale(size, size, size)
    -- the first face is on top, so that an opposite face, if any, lies on the floor
    local tilted, turned, placed = gr.node 'tilted', gr.node 'turned', gr.node 'placed'
    local nx, ny, nz = require 'meshes'.face_normal(verts, faces[1])
    local length = math.sqrt(nx * nx + ny * ny + nz * nz)
    tilted:rotate('z', -math.deg(math.acos(math.max(-1, math.min(1, -ny / length)))))
    local level = gr.node 'level'
    level:rotate('y', -math.deg(math.atan(nz, -nx)))
    level:add_child(solid)
    tilted:add_child(level)
    turned:rotate('y', turn or 0)
    turned:add_child(tilted)
    local low = turned:bounds()
    placed:translate(x, (y or 0) - low[2], z)
    placed:add_child(turned)
    scene:add_child(placed)
end

for k, name in ipairs { 'tetrahedron', 'cube', 'octahedron', 'icosahedron', 'dodecahedron' } do
    local verts, faces = polyhedra[name]()
    stand(verts, faces, studio.gold, 1.8 * (k - 3), 3.3, 0.74, 18 * k)
end
for k, name in ipairs(archimedean.names) do
    local verts, faces = archimedean.solid(name)
    local row = k <= 6 and 1 or 2
    local x = row == 1 and 2 * (k - 3.5) or 2 * (k - 10)
    stand(verts, faces, studio.glaze(colour.palette('toy', (k - 1) / 12)), x, row == 1 and 0.9 or -1.5, 0.84, 15 * k)
end

local steps = { 'k', 't', 'e', 'b', 'm', 'tk', 'o' }
for k, word in ipairs(steps) do
    local verts, faces = conway.on_sphere(conway.apply(word, polyhedra.dodecahedron()))
    stand(verts, faces, studio.silver, 2.25 * (k - 4), -4.1, 0.9, 10 * k)
end

studio.render { node = scene, file = 'show_solids.png', eye = { 0, 11.5, 17 }, target = { 0, 0.2, -0.5 }, fov = 22.5, key = { 9, 13, -7 }, lamp = 3,
    light = { 1.8, 1.65, 1.4 }, floor = { 0.30, 0.30, 0.31 } }
