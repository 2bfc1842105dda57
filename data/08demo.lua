-- TITLE: Soft shadows
-- Three area lights of different size and colour; the farther an object is from the floor, the softer its shadow.
-- Author: gray project

local stage = require 'stage'
local polyhedra = require 'polyhedra'
local meshes = require 'mesh_tools'

local root = gr.node('root')
local chalk = gr.material({ .80, .78, .74 }, { 0, 0, 0 }, 1)
root:add_child(stage.box('floor', chalk, { -9, -1, -7 }, { 9, 0, 9 }))
root:add_child(stage.box('wall', chalk, { -9, -.5, -3.4 }, { 9, 9, -2.6 }))

-- a stair of tall posts
local post = gr.material({ .62, .56, .48 }, { .1, .1, .1 }, 20)
for i = 0, 5 do
    root:add_child(stage.box('post', post, { -2.9 + i * .52, -.01, -1.4 + i * .25 }, { -2.74 + i * .52, 2.5 - .36 * i, -1.24 + i * .25 }))
end

root:add_child(stage.ball('ball', gr.material({ .70, .20, .16 }, { .5, .5, .5 }, 60), { 1.25, .75, -.55 }, .75))
root:add_child(stage.ball('floating', gr.material({ .20, .42, .62 }, { .5, .5, .5 }, 60), { -.45, 1.9, .5 }, .30))

-- a cage: the faces of an icosahedron, separated from each other
local verts, faces = polyhedra.icosahedron()
local apart_verts, apart_faces = {}, {}
for _, face in ipairs(faces) do
    local x, y, z = meshes.unit(meshes.face_normal(verts, face))
    local n = #apart_verts
    for i, index in ipairs(face) do
        local p = verts[index + 1]
        apart_verts[n + i] = { p[1] * .62 + x * .42, p[2] * .62 + y * .42, p[3] * .62 + z * .42 }
    end
    apart_faces[#apart_faces + 1] = { n, n + 1, n + 2 }
    -- the back, at a tiny distance, so that both sides have an outside
    for i, index in ipairs(face) do
        local p = verts[index + 1]
        apart_verts[n + 3 + i] = { p[1] * .62 + x * .405, p[2] * .62 + y * .405, p[3] * .62 + z * .405 }
    end
    apart_faces[#apart_faces + 1] = { n + 5, n + 4, n + 3 }
end
local cage = gr.geometry('petals', gr.mesh(gr.material({ .80, .62, .20 }, { .3, .3, .3 }, 40), apart_verts, apart_faces))
cage:scale(.72, .72, .72)
cage:rotate('x', 20)
cage:translate(2.75, .98, .95)
root:add_child(cage)

gr.render(root, '08demo.png', 640, 480, { .2, 2.6, 7.4 }, { 0, -.21, -1 }, { 0, 1, 0 }, 43, { .16, .16, .18 }, {
    gr.area_light({ -4.6, 5.2, 2.4 }, { 1.8, 0, 0 }, { 0, .6, 1.6 }, { .62, .54, .42 }, { 1, 0, 0 }),
    gr.area_light({ 4.2, 3.6, 3.2 }, { .5, 0, -.5 }, { 0, .7, 0 }, { .22, .30, .44 }, { 1, 0, 0 }),
    gr.area_light({ -.4, 6.5, -.6 }, { .8, 0, 0 }, { 0, 0, .8 }, { .24, .24, .24 }, { 1, 0, 0 }),
}, { background = { .12, .13, .16 } })
