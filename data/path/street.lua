-- TITLE: A street with a thousand lamps
-- OPTIONS: --spp 32
-- Everything that shines here lights the street: 880 bulbs on strings from house to house, lit windows, signs and
-- lanterns. The light sampler finds those that matter at each place by a hierarchy with powers, bounds and cones (Conty
-- and Kulla 2018).
local random = require 'random'
local dice = random.new(11)
local street = gr.node('street')
local function matte(r, g, b) return gr.material { kd = { r, g, b }, two_sided = true } end
local function glow(r, g, b, strength)
    return gr.material { kd = { 0, 0, 0 }, emission = { r * strength, g * strength, b * strength } }
end
local function box(material, min, max) street:add_child(gr.box { material = material, min = min, max = max }) end

-- Wet cobbles between two kerbs.
street:add_child(gr.plane { normal = { 0, 1, 0 }, material = gr.material {
    kd = { .11, .1, .1 }, ks = { .5, .5, .52 }, reflect = .35, roughness = .42 } })
for side = -1, 1, 2 do
    local a, b = side * 3.2, side * 4.6
    box(matte(.3, .29, .28), { math.min(a, b), 0, -60 }, { math.max(a, b), .14, 8 })
end

-- Houses, with windows of which many are lit.
local walls = { matte(.42, .2, .14), matte(.5, .44, .34), matte(.26, .31, .36), matte(.45, .3, .2), matte(.36, .4, .3) }
local dark, frame = matte(.03, .035, .05), matte(.6, .58, .54)
local warm = { glow(1, .62, .28, 2.2), glow(1, .72, .42, 1.5), glow(.75, .85, 1, 1.2) }
local bulbs = { glow(1, .7, .35, 60), glow(1, .35, .2, 60), glow(.4, .9, .5, 50), glow(.4, .6, 1, 60) }
local count = 0
for side = -1, 1, 2 do
    local z, number = 6, 0
    while z > -58 do
        local width, height, floors = dice:range(5, 7.5), dice:range(6.5, 10), dice:whole(2, 3)
        number = number + 1
        local x = side * 4.6
        box(walls[(number + side) % #walls + 1], { math.min(x, x + side * 6), 0, z - width },
            { math.max(x, x + side * 6), height, z - .02 })
        local columns = math.floor(width / 1.5)
        for floor = 0, floors - 1 do
            for column = 1, columns do
                local middle, sill = z - width * (column - .5) / columns, 1.1 + floor * 2.6
                local lit = dice:range(0, 1) < .62
                local pane = lit and dice:pick(warm) or dark
                local near, far = x - side * .02, x + side * .2
                box(pane, { math.min(near, far), sill, middle - .38 }, { math.max(near, far), sill + 1.25, middle + .38 })
                box(frame, { math.min(x - side * .1, far), sill - .1, middle - .48 },
                    { math.max(x - side * .1, far), sill, middle + .48 })
                if lit then count = count + 1 end
            end
        end
        if number % 2 == 0 then -- a sign above a shop
            local sign = dice:pick { glow(1, .2, .35, 4), glow(.25, .8, 1, 4), glow(.5, 1, .4, 3) }
            box(sign, { math.min(x - side * .7, x), 3.25, z - width * .5 - .04 },
                { math.max(x - side * .7, x), 3.6, z - width * .5 + .04 })
            count = count + 1
        end
        z = z - width
    end
end

-- Strings of bulbs across the street.
local string_of_bulbs = matte(.02, .02, .02)
for row = 0, 21 do
    local z, colour = 2 - row * 2.7, bulbs[row % #bulbs + 1]
    for i = 0, 39 do
        local t = (i + .5) / 40
        local sag = .9 * 4 * t * (1 - t)
        street:add_child(gr.sphere { centre = { -4.6 + 9.2 * t, 5.3 - sag, z }, radius = .035, material = colour })
        count = count + 1
    end
end

-- Lanterns on the kerbs.
for i = 0, 9 do
    for side = -1, 1, 2 do
        local x, z = side * 3.5, 1 - 6 * i - (side + 1)
        street:add_child(gr.cylinder { from = { x, .14, z }, to = { x, 3, z }, radius = .05, material = string_of_bulbs })
        street:add_child(gr.sphere { centre = { x, 3.15, z }, radius = .16, material = glow(1, .78, .5, 14) })
        count = count + 1
    end
end
print(count .. ' lamps')

gr.render {
    node = street, file = 'street.png', width = 480, height = 320, integrator = 'path', spp = 256, denoise = true,
    eye = { .9, 1.65, 6.5 }, target = { -.3, 2.3, -10 }, fov = 52, background = { .006, .009, .02 }, tone = 'filmic',
}
