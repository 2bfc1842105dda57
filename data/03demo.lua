-- TITLE: A mesh in the grid
-- The same mesh rendered twice, small, with the voxel grid and without it; both times are printed. Then the picture.
-- Author: gray project

local stage = require 'stage'
local knot = require 'knot'
local meshes = require 'mesh_tools'
local teapot = require 'teapot'

local lights = {
    gr.light({ -5, 8, 6 }, { .75, .72, .66 }, { 1, 0, 0 }),
    gr.light({ 6, 4, 5 }, { .25, .27, .32 }, { 1, 0, 0 }),
}
local blue = gr.material({ .16, .32, .60 }, { .5, .5, .5 }, 60)
local clay = gr.material({ .70, .36, .20 }, { .3, .3, .3 }, 30)
local floor = gr.material({ .70, .70, .66 }, { 0, 0, 0 }, 1)

--- A pot on a knot, with the given resolution.
local function scene(fine)
    local root = gr.node('root')
    root:add_child(stage.box('floor', floor, { -8, -.5, -8 }, { 8, 0, 5 }))
    local mesh = { knot.mesh(3, 7, { n = 90 * fine, around = 4 * fine, big = 1.5, small = .42, radius = .13 }) }
    local ring = stage.smooth('knot', blue, table.unpack(mesh))
    ring:translate(0, .56, 0)
    root:add_child(ring)
    local pot_mesh = { teapot.mesh(3 * fine) }
    local pot = stage.smooth('pot', clay, table.unpack(pot_mesh))
    pot:scale(.52, .52, .52)
    pot:rotate('y', 25)
    pot:translate(0, .30, 0)
    root:add_child(pot)
    local _, first = meshes.count(mesh[3])
    local _, second = meshes.count(pot_mesh[3])
    return root, first + second
end

local eye, view, up = { 0, 2.9, 5.2 }, { 0, -.42, -1 }, { 0, 1, 0 }
local ambient = { .22, .22, .25 }

local small, triangles = scene(1)
for _, accel in ipairs { 'grid', 'none' } do
    local start = os.clock()
    gr.render {
        node = small, file = '03demo_' .. accel .. '.png', width = 200, height = 150, eye = eye, view = view, up = up,
        fov = 42, ambient = ambient, lights = lights, accel = accel,
    }
    print(('%d triangles, 200 x 150, accel=%s: %.2f s of processor time'):format(triangles, accel, os.clock() - start))
end

local start = os.clock()
local big, many = scene(8)
print(('%d triangles: made in %.2f s'):format(many, os.clock() - start))
start = os.clock()
gr.render(big, '03demo.png', 640, 480, eye, view, up, 42, ambient, lights, { background = { .3, .34, .4 } })
print(('%d triangles, 640 x 480, accel=grid: %.2f s of processor time'):format(many, os.clock() - start))
