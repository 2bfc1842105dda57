-- TITLE: Clock
-- Six frames from one script: the hands turn between the renders, and each render takes the tree as it stands.
-- Author: gray project. Dialect: classic, new order (the hands come from a file).

local name = string.match(debug.getinfo(1, 'S').source, '([^/@]+)%.lua$')

local brass = gr.material({0.7, 0.5, 0.2}, {0.6, 0.5, 0.3}, 40)
local ivory = gr.material({0.9, 0.87, 0.78}, {0.1, 0.1, 0.1}, 10)
local ink = gr.material({0.08, 0.08, 0.1}, {0.3, 0.3, 0.3}, 20)
local red = gr.material({0.75, 0.12, 0.1}, {0.3, 0.3, 0.3}, 20)

local clock = gr.node('clock')
local rim = gr.sphere('rim')
rim:scale(1.25, 1.25, 0.3)
rim:translate(0, 0, -0.22)
rim:set_material(brass)
clock:add_child(rim)
local face = gr.sphere('face')
face:scale(1.08, 1.08, 0.04)
face:translate(0, 0, 0.05)
face:set_material(ivory)
clock:add_child(face)
for i = 0, 11 do
    local mark = gr.cube('mark' .. i)
    mark:translate(-0.5, 0, -0.5)
    mark:scale(i % 3 == 0 and 0.07 or 0.035, 0.14, 0.05)
    mark:translate(0, 0.82, 0.07)
    mark:rotate('z', -30 * i)
    mark:set_material(ink)
    clock:add_child(mark)
end

local function hand(length, width, lift, material)
    local turning = gr.node('turning')
    local h = gr.mesh('hand', 'hand.obj')
    h:scale(width, length, 1)
    h:translate(0, 0, lift)
    h:set_material(material)
    turning:add_child(h)
    clock:add_child(turning)
    return turning
end
local hours = hand(0.5, 0.8, 0.13, ink)
local minutes = hand(0.8, 0.7, 0.18, ink)
local seconds = hand(0.85, 0.3, 0.23, red)
local pin = gr.nh_sphere('pin', {0, 0, 0.25}, 0.06)
pin:set_material(brass)
clock:add_child(pin)

local lights = { gr.light({-3, 4, 6}, {0.7, 0.7, 0.65}, {1, 0, 0}), gr.light({4, 0, 5}, {0.25, 0.25, 0.3}, {1, 0, 0}) }
-- ten past ten; every frame is two minutes and five seconds later
hours:rotate('z', -305)
minutes:rotate('z', -60)
for frame = 1, 6 do
    gr.render(clock, name .. frame .. '.png', 160, 160, {0, 0, 6}, {0, 0, -1}, {0, 1, 0}, 26, {0.3, 0.3, 0.3}, lights,
        {background = {0.2, 0.24, 0.3}})
    hours:rotate('z', -1.04)
    minutes:rotate('z', -12.5)
    seconds:rotate('z', -30)
end
