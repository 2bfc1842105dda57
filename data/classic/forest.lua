-- TITLE: Forest
-- One fir and one bush, 900 nodes: instances cost nearly nothing.
-- Author: gray project. Dialect: project.

local lathe = require 'lathe'
local polyhedra = require 'polyhedra'
local noise = require 'noise'

local root = gr.node('forest')

local bark = gr.material({ .30, .20, .13 }, { 0, 0, 0 }, 1)
local fir = gr.node('fir')
fir:add_child(gr.geometry('trunk', gr.vn_mesh(bark, lathe.turn({ { .09, 0 }, { .05, 2 }, { .01, 3 } }, 8))))
for k = 0, 4 do
    local wide, low = .85 - .15 * k, .45 + .5 * k
    local skirt = lathe.carved({ { .02, low + .1 }, { wide, low }, { wide * .55, low + .32 }, { 0, low + .85 } }, 28,
        function(angle, t) return 1 + .13 * math.cos(7 * angle + k) * (1 - t) end)
    fir:add_child(gr.geometry('skirt', gr.vn_mesh(gr.material({ .10 + .02 * k, .27 + .03 * k, .13 }, { .03, .03, .03 }, 5),
        table.unpack(skirt))))
end
local bush = gr.geometry('bush', gr.mesh(gr.material({ .34, .40, .14 }, { 0, 0, 0 }, 1), polyhedra.subdivide(polyhedra.loop, 2, polyhedra.icosahedron())))

-- the land: a height field
local function height(x, z) return 1.6 * noise.sum(x * .09 + 3.1, .5, z * .09 + 1.7, 3) end
local verts, faces, n = {}, {}, 80
for i = 0, n do
    for j = 0, n do
        local x, z = -24 + 48 * i / n, -42 + 50 * j / n
        verts[#verts + 1] = { x, height(x, z), z }
        if i > 0 and j > 0 then
            local k = #verts - 1
            faces[#faces + 1] = { k, k - 1, k - n - 2, k - n - 1 }
        end
    end
end
root:add_child(gr.geometry('land', gr.vn_mesh(gr.material({ .32, .38, .18 }, { 0, 0, 0 }, 1),
    table.unpack(require('meshes').smooth(verts, faces)))))

math.randomseed(7)
for k = 1, 900 do
    local x, z = -22 + 44 * math.random(), -40 + 44 * math.random()
    if math.abs(x - 2.5 * math.sin(z * .2)) > 1.6 then
        local at = gr.node('tree ' .. k)
        local is_bush = k % 6 == 0
        local size = is_bush and .25 + .2 * math.random() or .7 + .7 * math.random()
        at:scale(size, size * (.9 + .3 * math.random()), size)
        at:rotate('y', 360 * math.random())
        at:translate(x, height(x, z) - .03, z)
        at:add_child(is_bush and bush or fir)
        root:add_child(at)
    end
end

gr.render {
    node = root, file = 'forest.png', width = 480, height = 320, eye = { 0, height(0, 7) + 4.2, 8 }, view = { 0, -.24, -1 },
    fov = 48, ambient = { .34, .36, .42 }, background = { .72, .80, .88 },
    lights = { gr.light({ -40, 45, 10 }, { .8, .74, .6 }, { 1, 0, 0 }) },
}
