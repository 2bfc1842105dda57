-- TITLE: Phong normals
-- The same coarse meshes with flat faces (behind) and with normals interpolated over the faces (in front).
-- Author: gray project

local stage = require 'stage'
local knot = require 'knot'
local teapot = require 'teapot'
local polyhedra = require 'polyhedra'
local lathe = require 'lathe'

local root = gr.node('root')
root:add_child(stage.box('floor', gr.material({ .60, .62, .58 }, { 0, 0, 0 }, 1), { -12, -1, -12 }, { 12, 0, 8 }))

local jade = gr.material({ .20, .50, .36 }, { .5, .5, .5 }, 50)
local plum = gr.material({ .50, .22, .42 }, { .5, .5, .5 }, 50)
local honey = gr.material({ .76, .50, .14 }, { .5, .5, .5 }, 50)
local slate = gr.material({ .28, .36, .50 }, { .5, .5, .5 }, 50)

local things = {
    { jade, -2.9, .40, 0, { teapot.mesh(3) } },
    { plum, -.75, .78, .80, { polyhedra.geodesic(1) } },
    { honey, 1.15, .80, 0, { lathe.turn(lathe.spline({ { 0, 0 }, { .55, 0 }, { .75, .5 }, { .3, 1.1 }, { .45, 1.6 }, { 0, 1.75 } }, 2), 10) } },
    { slate, 3.05, .62, .62, { knot.mesh(2, 3, { n = 36, around = 7, big = .85, small = .35, radius = .22 }) } },
}
for k, thing in ipairs(things) do
    local material, x, size, lift, mesh = table.unpack(thing)
    local flat = gr.geometry('flat ' .. k, gr.mesh(material, mesh[1], mesh[3]))
    local smooth = gr.geometry('smooth ' .. k, gr.vn_mesh(material, table.unpack(mesh)))
    for row, node in ipairs { flat, smooth } do
        node:scale(size, size, size)
        node:rotate('y', 20)
        node:translate(x * (row == 1 and 1.2 or .92), lift, row == 1 and -2.3 or 1.3)
        root:add_child(node)
    end
end

gr.render {
    node = root, file = '04demo.png', width = 640, height = 480,
    eye = { 0, 4.9, 9.2 }, view = { 0, -.42, -1 }, fov = 38,
    ambient = { .25, .25, .27 }, background = { .52, .58, .64 },
    lights = {
        gr.light({ -6, 9, 7 }, { .72, .70, .64 }, { 1, 0, 0 }),
        gr.light({ 6, 5, 8 }, { .22, .24, .30 }, { 1, 0, 0 }),
    },
}
