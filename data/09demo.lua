-- TITLE: Constructive solid geometry
-- Union, difference and intersection of spheres, cubes and a closed mesh: a die, a lens, an egg cup, a nested lantern, a
-- knot sawn through. A cut shows the material of the solid that made it.
-- Author: gray project

local stage = require 'stage'
local knot = require 'knot'

local box, ball = stage.box, stage.ball
local root = gr.node('root')
root:add_child(stage.checkers('floor', gr.rr_material({ .36, .38, .40 }, { .3, .3, .3 }, 40, .15, 0, 1),
    gr.rr_material({ .62, .62, .58 }, { .3, .3, .3 }, 40, .15, 0, 1), -8, -9, 8, 5, 1))

local ivory = gr.material({ .82, .78, .68 }, { .4, .4, .4 }, 60)
local red = gr.material({ .70, .10, .10 }, { .4, .4, .4 }, 60)
local blue = gr.material({ .14, .26, .60 }, { .4, .4, .4 }, 60)
local gold = gr.rr_material({ .55, .38, .12 }, { .7, .55, .3 }, 50, .2, 0, 1)
local green = gr.material({ .16, .46, .26 }, { .4, .4, .4 }, 60)
local glass = gr.difresnel_material(gr.rr_material({ 0, 0, 0 }, { .95, .97, .98 }, 200, 0, 1, 1.5))

--- Joins a list of nodes.
local function all_of(name, list)
    local sum = list[1]
    for k = 2, #list do sum = gr.csg_union(name, sum, list[k]) end
    return sum
end

-- a die: cube with round edges, pips hollowed out
local function die()
    local spots = {}
    local function pip(x, y, z) spots[#spots + 1] = ball('pip', blue, { x, y, z }, .13) end
    pip(0, .62, 0)
    for _, s in ipairs { -.28, .28 } do
        pip(s, s, .62)
        pip(.62, s, -s)
        pip(.62, s, s)
        pip(-.62, s, 0)
    end
    pip(.62, 0, 0)
    local body = gr.csg_intersection('body', box('cube', ivory, { -.58, -.58, -.58 }, { .58, .58, .58 }),
        ball('round', ivory, { 0, 0, 0 }, .80))
    return gr.csg_difference('die', body, all_of('pips', spots))
end
local cube = die()
cube:rotate('y', -28)
cube:translate(-2.5, .582, .9)
root:add_child(cube)

-- a drilled sphere inside a drilled cube
local function drilled(solid, material, width)
    local drills = {}
    for _, axis in ipairs { 'x', 'y', 'z' } do
        local bore = gr.geometry('bore', gr.sphere(material))
        bore:scale(9, width, width)
        if axis == 'y' then bore:rotate('z', 90) end
        if axis == 'z' then bore:rotate('y', 90) end
        drills[#drills + 1] = bore
    end
    return gr.csg_difference('drilled', solid, all_of('drills', drills))
end
local outer = drilled(gr.csg_intersection('block', box('c', green, { -1, -1, -1 }, { 1, 1, 1 }), ball('s', green, { 0, 0, 0 }, 1.36)), gold, .66)
local inner = drilled(ball('core', red, { 0, 0, 0 }, .60), ivory, .26)
local turners = gr.node('nested')
turners:add_child(outer)
turners:add_child(inner)
turners:add_child(ball('pearl', ivory, { 0, 0, 0 }, .2))
turners:rotate('y', 30)
turners:translate(.05, 1.002, -1.5)
root:add_child(turners)

-- a lens: two spheres
local lens = gr.csg_intersection('lens', ball('a', glass, { 0, 0, -1.15 }, 1.4), ball('b', glass, { 0, 0, 1.15 }, 1.4))
lens:rotate('y', 22)
lens:translate(.55, .80, 1.7)
root:add_child(lens)

-- an apple with a bite and tooth marks
local bites = {}
for k = -2, 2 do bites[#bites + 1] = ball('tooth', ivory, { .80 + .06 * math.abs(k), .10 + .22 * k, .42 - .04 * k * k }, .34) end
local apple = gr.csg_difference('apple',
    gr.csg_difference('fruit', ball('flesh', red, { 0, 0, 0 }, .8), ball('dimple', red, { 0, 1.05, 0 }, .42)), all_of('bite', bites))
apple:rotate('y', -22)
apple:translate(2.55, .80, .35)
root:add_child(apple)
root:add_child(box('stalk', gr.material({ .25, .16, .08 }, { 0, 0, 0 }, 1), { 2.53, 1.36, .33 }, { 2.58, 1.78, .38 }))

-- a closed mesh sawn through
local rope = gr.geometry('rope', gr.vn_mesh(blue, knot.mesh(2, 3, { n = 200, around = 20, radius = .21 })))
rope:rotate('x', 90)
local saw = box('saw', gold, { -3, -3, .0 }, { 3, 3, 3 })
local sawn = gr.csg_difference('sawn knot', rope, saw)
sawn:scale(.85, .85, .85)
sawn:rotate('y', 25)
sawn:translate(-2.5, 1.35, -1.9)
root:add_child(sawn)

-- a bowl: half a shell with a wavy rim
local cuts = { box('above', ivory, { -2, .15, -2 }, { 2, 2, 2 }), ball('hollow', gold, { 0, 0, 0 }, .72) }
for k = 0, 11 do
    local a = math.pi * k / 6
    cuts[#cuts + 1] = ball('wave', ivory, { .78 * math.cos(a), .15, .78 * math.sin(a) }, .14)
end
local bowl = gr.csg_difference('bowl', ball('shell', ivory, { 0, 0, 0 }, .78), all_of('cuts', cuts))
bowl:translate(2.5, .78, -2.2)
root:add_child(bowl)

gr.render {
    node = root, file = '09demo.png', width = 640, height = 480,
    eye = { .1, 3.2, 7.4 }, view = { 0, -.33, -1 }, fov = 44,
    ambient = { .26, .26, .28 }, background = { .60, .66, .74 },
    lights = {
        gr.light({ -5, 8, 7 }, { .68, .66, .60 }, { 1, 0, 0 }),
        gr.light({ 6, 6, 6 }, { .26, .28, .34 }, { 1, 0, 0 }),
    },
}
