-- TITLE: Perlin noise
-- Marble (left) and wood (right) in three shapes each; the front row interpolates with the cosine, the back row does not.
-- Author: gray project

local stage = require 'stage'
local teapot = require 'teapot'

local root = gr.node('root')
root:add_child(stage.box('floor', gr.rr_material({ .32, .33, .36 }, { .3, .3, .3 }, 40, .18, 0, 1), { -12, -1, -14 }, { 12, 0, 8 }))

local stone = gr.material({ .86, .84, .80 }, { .45, .45, .45 }, 90)
local dark_stone = gr.material({ .12, .30, .24 }, { .5, .5, .5 }, 90)
local pine = gr.material({ .78, .56, .32 }, { .2, .2, .2 }, 25)
local teak = gr.material({ .44, .24, .11 }, { .25, .25, .2 }, 30)

local pot = { teapot.mesh(10) }
for row = 0, 1 do
    local z = row == 0 and -2.1 or .9
    local x = row == 0 and 1.12 or 1
    local white = gr.marble_pnd_material(stone, 1.1, 5, 7, row, { .26, .26, .32 })
    local green = gr.marble_pnd_material(dark_stone, 2, 4, 3, row, { .80, .86, .78 })
    local light = gr.wood_pnd_material(pine, 1.1, 9, row, { .50, .29, .13 })
    local brown = gr.wood_pnd_material(teak, .8, 12, row, { .20, .09, .04 })

    local function at(node, px, py, size)
        node:scale(size, size, size)
        node:translate(px * x, py, z)
        root:add_child(node)
    end
    at(gr.geometry('marble ball', gr.sphere(white)), -3.35, .72, .72)
    local cube = gr.geometry('marble cube', gr.cube(green))
    cube:translate(-.5, 0, -.5)
    cube:rotate('y', 30)
    at(cube, -1.75, .001, 1.15)
    at(gr.geometry('wooden ball', gr.sphere(brown)), 3.35, .72, .72)
    local block = gr.geometry('wooden cube', gr.cube(light))
    block:translate(-.5, 0, -.5)
    block:rotate('y', -30)
    at(block, 1.8, .001, 1.15)
    -- a mesh takes its pattern from its own coordinates, about six units across here
    local big = row == 0 and gr.marble_pnd_material(stone, .4, 5, 2.4, row, { .45, .22, .18 })
        or gr.wood_pnd_material(teak, .35, 10, row, { .20, .09, .04 })
    local vessel = gr.geometry('pot', gr.vn_mesh(big, table.unpack(pot)))
    vessel:rotate('y', 25)
    at(vessel, 0, .001, .37)
end

gr.render {
    node = root, file = '06demo.png', width = 640, height = 480,
    eye = { 0, 3.5, 8.0 }, view = { 0, -.40, -1 }, fov = 44,
    ambient = { .28, .28, .30 }, background = { .42, .46, .52 },
    lights = {
        gr.light({ -6, 9, 7 }, { .70, .68, .62 }, { 1, 0, 0 }),
        gr.light({ 7, 6, 6 }, { .24, .26, .32 }, { 1, 0, 0 }),
    },
}
