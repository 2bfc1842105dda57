-- A knot and a pot on a plane under the clear sky: detail of geometry in smooth light.
local function matte(r, g, b) return gr.material { kd = { r, g, b } } end
local scene = gr.node('scene')
scene:add_child(gr.plane { normal = { 0, 1, 0 }, material = matte(.6, .58, .55) })

local verts, normals, faces, corners = require('knot').mesh(2, 3, { n = 200, around = 16, radius = .2 })
local knot = gr.vn_mesh(matte(.7, .25, .15), verts, normals, faces, corners)
knot:translate(-1.1, .62, 0)
scene:add_child(knot)

verts, normals, faces, corners = require('teapot').mesh(8)
local pot = gr.vn_mesh(matte(.2, .4, .65), verts, normals, faces, corners)
pot:scale(.42, .42, .42)
pot:translate(1.3, 0, .2)
scene:add_child(pot)

gr.render {
    node = scene, file = 'mesh_sky.png', width = 128, height = 128, integrator = 'path',
    eye = { 0, 2.4, 5.2 }, target = { .05, .45, 0 }, fov = 38,
    background = gr.clear_sky { hour = 16, day = 200, latitude = 48 },
}
