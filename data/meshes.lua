-- TITLE: Mesh files
-- OBJ with MTL, PLY, STL and glTF; materials by part, crease angles, placing by bounds. models/make.lua makes the
-- files. Author: gray project

local scene = gr.node('scene')
local stone = gr.material({ .58, .56, .52 }, { .1, .1, .1 }, 20)
scene:add_child(gr.plane { normal = { 0, 1, 0 }, material = gr.material({ .58, .60, .62 }, { 0, 0, 0 }, 1) })

--- Puts a model upright on a round pedestal, scaled to `size` and centred.
local function exhibit(model, size, x, z, turn)
    model:rotate('y', turn or 0)
    local low, high = model:bounds()
    local across = math.max(high[1] - low[1], high[2] - low[2], high[3] - low[3])
    model:translate(-(low[1] + high[1]) / 2, -low[2], -(low[3] + high[3]) / 2)
    model:scale(size / across, size / across, size / across)
    model:translate(x, .35, z)
    scene:add_child(model)
    scene:add_child(gr.cylinder { from = { x, 0, z }, to = { x, .35, z }, radius = 1.05, material = stone })
end

local gold = gr.rr_material({ .42, .28, .08 }, { .55, .42, .2 }, 80, .35, 0, 1)
local steel = gr.rr_material({ .34, .36, .40 }, { .45, .46, .5 }, 70, .25, 0, 1)
local ivory = gr.material { kd = { .72, .66, .52 }, ks = { .2, .2, .2 }, shininess = 40, two_sided = true }

-- the same file unchanged, and with other materials for two of its parts
exhibit(gr.mesh { file = 'models/rocket.obj', smooth = 40 }, 3.3, -4.3, -.6, 20)
exhibit(gr.mesh { file = 'models/rocket.obj', smooth = 40, materials = { hull = gold, fins = steel } }, 3.3, -1.6, -1.6, -10)

-- STL has no normals: smooth normals everywhere would round the teeth; a crease angle keeps their edges
exhibit(gr.mesh { file = 'models/gear.stl', material = steel, smooth = 25 }, 2, 1.1, -1.6, 25)
exhibit(gr.mesh { file = 'models/gear.stl', material = ivory, smooth = 180 }:rotate('x', -50), 2, 3.8, -.6, -35)

-- colours at vertices; nodes, pictures and a normal map
exhibit(gr.mesh { file = 'models/knot.ply', smooth = 180 }:rotate('x', 70), 2, -2.4, 1.7, 0)
local has_gltf, crates = pcall(gr.mesh, { file = 'models/crate.gltf' })
if has_gltf then
    exhibit(crates, 1.9, 1.9, 1.7, 24)
else
    print(crates)
    exhibit(gr.mesh { file = 'models/gear.stl', material = gold, smooth = 25 }, 1.9, 1.9, 1.7, 24)
end

gr.render {
    node = scene, file = 'meshes.png', width = 900, height = 560, eye = { 0, 4.6, 12.5 }, target = { -.2, 1.15, -.2 }, fov = 32,
    ambient = { .24, .25, .28 }, background = { .62, .70, .80 }, lights = {
        gr.area_light({ -9, 10, 6 }, { 2.5, 0, 0 }, { 0, 1, 2 }, { .82, .78, .72 }, { 1, 0, 0 }),
        gr.light({ 10, 7, 9 }, { .22, .24, .30 }, { 1, 0, 0 }),
    },
}
