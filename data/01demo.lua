-- TITLE: Adaptive anti-aliasing
-- Fans of thin bars, a lattice of small spheres and a floor that runs to the horizon: everything that shows aliasing.
-- Author: gray project
--
-- `gray 01demo.lua -ss 5 -write-aa-targets red_ -write-pre-aa raw_` also writes red_01demo.png, the first pass with the
-- pixels that will be refined in red, and raw_01demo.png, the first pass itself.

local stage = require 'stage'

local root = gr.node('root')

local ink = gr.material({ .10, .10, .12 }, { 0, 0, 0 }, 1)
local paper = gr.material({ .90, .88, .82 }, { 0, 0, 0 }, 1)
root:add_child(stage.checkers('floor', ink, paper, -16, -60, 16, 4, 1))

-- two fans of bars, one with high contrast against the sky, one with low contrast
local function fan(name, count, length, material, x, y, z)
    local bar = gr.geometry(name .. ' bar', gr.cube(material))
    bar:translate(-.5, 0, -.5)
    bar:scale(.028, length, .028)
    for i = 0, count - 1 do
        local at = gr.node(name .. i)
        at:rotate('z', -75 + 150 * i / (count - 1))
        at:translate(x, y, z)
        at:add_child(bar)
        root:add_child(at)
    end
end
fan('fan', 41, 3.1, gr.material({ .92, .55, .12 }, { .3, .3, .2 }, 30), -2.35, .02, 0)
fan('pale', 41, 3.1, gr.material({ .30, .42, .72 }, { .2, .2, .2 }, 30), 2.35, .02, -.6)

-- a lattice of small spheres, one primitive under many nodes
local bead = gr.sphere(gr.material({ .75, .12, .14 }, { .6, .6, .6 }, 60))
local pearl = gr.geometry('bead', bead)
pearl:scale(.085, .085, .085)
for i = -3, 3 do
    for j = 0, 6 do
        for k = -3, 3 do
            if math.max(math.abs(i), math.abs(j - 3), math.abs(k)) == 3 then
                local at = gr.node('at')
                at:translate(i * .24, j * .24, k * .24)
                at:rotate('y', 32)
                at:translate(0, .35, 1)
                at:add_child(pearl)
                root:add_child(at)
            end
        end
    end
end

gr.render {
    node = root, file = '01demo.png', width = 640, height = 480,
    eye = { 0, 1.7, 6.4 }, view = { 0, -.07, -1 }, fov = 42,
    ambient = { .3, .3, .32 }, background = { .70, .80, .90 },
    lights = {
        gr.light({ -6, 9, 8 }, { .7, .68, .62 }, { 1, 0, 0 }),
        gr.light({ 7, 5, 6 }, { .25, .27, .32 }, { 1, 0, 0 }),
    },
}
