-- TITLE: Caustics
-- Light focused by glass, gold and water: a clear ball, a gold ring with its nephroid, a green bottle, the floor of a
-- pool. Author: gray project

local stage = require 'stage'

local root = gr.node('root')
local sin, cos, pi = math.sin, math.cos, math.pi

-- A small generator of its own, so that the picture is the same everywhere.
local seed = 11
local function random(low, high)
    seed = (seed * 16807) % 2147483647
    return low + (high - low) * seed / 2147483647
end

-- The terrace and the pool sunk into it.
local stone = gr.material({ .66, .62, .55 }, { 0, 0, 0 }, 1)
local edge = gr.material({ .80, .78, .73 }, { 0, 0, 0 }, 1)
local tile = gr.material({ .52, .74, .78 }, { 0, 0, 0 }, 1)
local joint = gr.material({ .30, .50, .56 }, { 0, 0, 0 }, 1)
local left, right, back, front, depth = -4.2, 4.2, .9, 6, 1.3
local function slab(name, material, low, high) root:add_child(stage.box(name, material, low, high)) end
slab('terrace', stone, { -30, -.5, -40 }, { 30, 0, back - .35 })
slab('left bank', stone, { -30, -.5, back - .35 }, { left - .35, 0, 20 })
slab('right bank', stone, { right + .35, -.5, back - .35 }, { 30, 0, 20 })
slab('kerb', edge, { left - .35, -.5, back - .35 }, { right + .35, .06, back })
slab('left kerb', edge, { left - .35, -.5, back }, { left, .06, 20 })
slab('right kerb', edge, { right, -.5, back }, { right + .35, .06, 20 })
slab('pool floor', joint, { left - 1, -depth - .5, back - 1 }, { right + 1, -depth - .015, 20 })
slab('pool wall', tile, { left - 1, -depth, back - 1 }, { right + 1, -.5, back })
slab('pool left', tile, { left - 1, -depth, back }, { left, -.5, 20 })
slab('pool right', tile, { right, -depth, back }, { right + 1, -.5, 20 })
local tiles, size = gr.node('tiles'), .42
for i = 0, math.floor((right - left) / size) do
    for j = 0, math.floor((front - back) / size) do
        local x, z = left + i * size, back + j * size
        tiles:add_child(stage.box('tile', tile, { x + .012, -depth - .1, z + .012 }, { x + size - .012, -depth, z + size - .012 }))
    end
end
root:add_child(tiles)

-- Water: waves of many directions, the short ones low. It extends slightly into the walls, so that its sides are
-- hidden.
local waves = {}
for k = 1, 14 do
    local length, angle = random(.42, 1.5), random(0, 2 * pi)
    waves[k] = { 2 * pi / length * cos(angle), 2 * pi / length * sin(angle), .0072 * length ^ 1.4, random(0, 2 * pi) }
end
local wide, long, columns, rows = right - left + .2, front - back + 1.2, 168, 126
local heights = {}
for j = 0, rows do
    local row = {}
    for i = 0, columns do
        local x, z, h = wide * i / columns, long * j / rows, 0
        for _, w in ipairs(waves) do h = h + w[3] * sin(w[1] * x + w[2] * z + w[4]) end
        row[i + 1] = h
    end
    heights[j + 1] = row
end
local water = gr.height_field {
    name = 'water', heights = heights, floor = -2, smooth = true,
    material = gr.difresnel_material(gr.rr_material {
        kd = { 0, 0, 0 }, ks = { 1, 1, 1 }, shininess = 1, refract = 1, ior = 1.33, absorption = { .16, .04, .03 } }),
}
water:scale(wide, 1, long)
water:translate(left - .1, -.14, back - .1)
root:add_child(water)

-- A ball of clear glass.
local glass = gr.difresnel_material(gr.rr_material({ 0, 0, 0 }, { 1, 1, 1 }, 200, 0, 1, 1.52))
root:add_child(stage.ball('ball', glass, { -.15, .75, -1.0 }, .75))

-- A gold ring, polished inside and outside.
local gold = gr.rr_material({ .22, .15, .05 }, { .95, .74, .36 }, 80, .85, 0, 1)
local ring = gr.lathe { name = 'ring', material = gold, loop = true,
    points = { { .9, 0 }, { .96, 0 }, { .96, .4 }, { .9, .4 } } }
ring:translate(2.55, 0, -1.05)
root:add_child(ring)

-- A green bottle full of water: its wall colours the light, its body gathers it. The water overlaps the wall a little.
local green = gr.difresnel_material(gr.rr_material {
    kd = { 0, 0, 0 }, ks = { 1, 1, 1 }, shininess = 100, refract = 1, ior = 1.5, absorption = { 9, .5, 6 } })
local clear = gr.difresnel_material(gr.rr_material({ 0, 0, 0 }, { 1, 1, 1 }, 100, 0, 1, 1.33))
local bottle = gr.node('bottle')
bottle:add_child(gr.lathe { name = 'glass', material = green, spline = 'catmull-rom',
    points = { { 0, 0 }, { .45, 0 }, { .54, .07 }, { .55, .5 }, { .55, 1.15 }, { .46, 1.5 }, { .22, 1.85 }, { .17, 2.3 },
        { .21, 2.36 }, { .2, 2.45 }, { .14, 2.45 }, { .11, 2.3 }, { .18, 1.85 }, { .41, 1.48 }, { .5, 1.14 }, { .5, .5 },
        { .46, .12 }, { .3, .08 }, { 0, .13 } } })
bottle:add_child(gr.lathe { name = 'water in it', material = clear, spline = 'catmull-rom',
    points = { { 0, .12 }, { .3, .07 }, { .465, .11 }, { .505, .5 }, { .505, 1.14 }, { .415, 1.48 }, { .2, 1.8 }, { 0, 1.8 } } })
bottle:scale(.92, .92, .92)
bottle:translate(-3.05, 0, -1.45)
root:add_child(bottle)

gr.render {
    node = root, file = '07demo.png', width = 640, height = 480,
    eye = { .1, 5.4, 7.6 }, target = { .1, -.4, -.05 }, fov = 40,
    ambient = { .13, .155, .20 }, background = { .50, .66, .85 },
    reflect_limit = 4, refract_limit = 8, use_tir = true,
    caustics = { photons = PHOTONS or 600000 },
    lights = { gr.directional_light({ .72, -.62, .26 }, { 1.45, 1.34, 1.15 }) },
}
