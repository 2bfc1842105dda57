-- TITLE: Snowman
-- Three balls of snow, coal, a carrot and a hat.
-- Author: gray project. Dialect: classic, new order.

local snow = gr.material({0.9, 0.92, 0.95}, {0.1, 0.1, 0.1}, 10)
local coal = gr.material({0.05, 0.05, 0.06}, {0.4, 0.4, 0.4}, 30)
local orange = gr.material({0.9, 0.45, 0.1}, {0.1, 0.1, 0.1}, 10)
local felt = gr.material({0.12, 0.1, 0.14}, {0.2, 0.2, 0.2}, 8)
local wool = gr.material({0.7, 0.1, 0.12}, {0, 0, 0}, 1)

local man = gr.node('man')
local heights, sizes = {0.9, 2.25, 3.2}, {1, 0.75, 0.5}
for i = 1, 3 do
    local ball = gr.sphere('ball' .. i)
    ball:scale(sizes[i], sizes[i] * 0.95, sizes[i])
    ball:translate(0, heights[i], 0)
    ball:set_material(snow)
    man:add_child(ball)
end
local function pebble(x, y, z, r)
    local p = gr.nh_sphere('pebble', {x, y, z}, r)
    p:set_material(coal)
    man:add_child(p)
end
pebble(-0.18, 3.35, 0.44, 0.06)
pebble(0.18, 3.35, 0.44, 0.06)
for i = 0, 2 do pebble(0, 2.0 + 0.25 * i, 0.70 + 0.02 * (i % 2), 0.07) end
for i = -2, 2 do pebble(0.09 * i, 3.0 + 0.02 * i * i, 0.44, 0.035) end

local nose = gr.mesh('nose', 'carrot.obj')
nose:scale(0.6, 0.6, 0.7)
nose:translate(0, 3.2, 0.45)
nose:set_material(orange)
man:add_child(nose)

local hat = gr.mesh('hat', 'hat.obj')
hat:scale(0.42, 0.42, 0.42)
hat:rotate('z', -8)
hat:translate(0.05, 3.58, 0)
hat:set_material(felt)
man:add_child(hat)

local scarf = gr.sphere('scarf')
scarf:scale({0.52, 0.12, 0.52})
scarf:translate({0, 2.82, 0})
scarf:set_material(wool)
man:add_child(scarf)

for side = -1, 1, 2 do
    local arm = gr.cube('arm')
    arm:translate(0, -0.5, -0.5)
    arm:scale(1.1, 0.07, 0.07)
    arm:rotate('z', 28)
    arm:translate(0.65, 2.35, 0)
    local mirrored = gr.node('side')
    mirrored:scale(side, 1, 1)
    mirrored:add_child(arm)
    arm:set_material(felt)
    man:add_child(mirrored)
end

local ground = gr.nh_sphere('ground', {0, -60, 0}, 60)
ground:set_material(snow)
local scene = gr.node('scene')
scene:add_child(man)
scene:add_child(ground)

gr.render(scene, 'snowman.png', 300, 400, {2.2, 2.9, 7.6}, {-0.27, -0.12, -1}, {0, 1, 0}, 34, {0.35, 0.38, 0.45},
    {gr.light({-6, 8, 8}, {0.65, 0.6, 0.5}, {1, 0, 0})},
    {background = {0.6, 0.68, 0.78}})
