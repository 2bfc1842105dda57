-- TITLE: A street with a thousand lamps
-- OPTIONS: --spp 32
-- All lamps illuminate the street: lanterns on strings between the houses, along the houses and on the kerbs, lit
-- windows, a clock. The light sampler finds the important lamps for each point by a hierarchy with powers, bounds and
-- cones (Conty and Kulla 2018).
-- Even the farthest lantern is wider than two pixels, because the brightness of a smaller one would depend on its position.
local random = require 'random'
local dice = random.new(11)
local street = gr.node('street')
local function matte(r, g, b) return gr.material { kd = { r, g, b }, two_sided = true } end
local function glow(r, g, b, strength)
    return gr.material { kd = { 0, 0, 0 }, emission = { r * strength, g * strength, b * strength } }
end
local function box(material, min, max) street:add_child(gr.box { material = material, min = min, max = max }) end
-- A box of the left (-1) or right (1) row of houses: x counts from the middle of the street.
local function beside(material, side, x0, x1, y0, y1, z0, z1)
    box(material, { math.min(side * x0, side * x1), y0, z0 }, { math.max(side * x0, side * x1), y1, z1 })
end
local near, far, half, kerb = 7, -30, 3.7, 2.8
local eye = { .7, 1.65, 6.5 }
local count = 0
local function lantern(material, x, y, z, radius)
    street:add_child(gr.sphere { centre = { x, y, z }, radius = radius, material = material })
    count = count + 1
end

-- Wet flagstones between two kerbs, with puddles.
local function stones(p)
    local row = math.floor(p.z / .7)
    local x, z = p.x + .45 * (row % 2), p.z
    local column = math.floor(x / .9)
    local edge = gr.min(gr.min(x - column * .9, column * .9 + .9 - x), gr.min(z - row * .7, row * .7 + .7 - z))
    local tint = gr.hash(column, row, 0)
    return gr.smoothstep(.005, .03, edge) * gr.mix({ .1, .095, .09 }, { .32, .29, .26 }, tint)
end
local function wetness(p)
    local n = gr.noise(p.x * .55, 0, p.z * .4) + .5 * gr.noise(p.x * 1.3, 4, p.z)
    return gr.mix(.1, .36, gr.smoothstep(-.25, .35, n))
end
street:add_child(gr.rectangle { corner = { -kerb, 0, near }, along = { 2 * kerb, 0, 0 }, up = { 0, 0, far - near },
    material = gr.openpbr_material { base_color = gr.fn(stones, 1), specular_roughness = gr.fn(wetness, 1) } })
local pavement = gr.openpbr_material { base_color = { .2, .19, .18 }, specular_roughness = .5 }
for side = -1, 1, 2 do beside(pavement, side, kerb, half + .1, -.1, .13, far, near) end

-- Houses, with windows of which many are lit.
local walls = { matte(.62, .24, .15), matte(.74, .6, .36), matte(.32, .45, .56), matte(.7, .42, .24), matte(.46, .56, .38) }
local dark, timber, trim = matte(.03, .035, .05), matte(.12, .07, .045), matte(.55, .5, .44)
local roof = matte(.25, .13, .1)
local warm = { glow(1, .5, .18, .8), glow(1, .6, .26, .7), glow(1, .68, .36, .6) }
local red, orange, yellow = glow(1, .07, .03, 1.5), glow(1, .27, .04, 1.6), glow(1, .55, .14, 1.8)
local rose, green, blue = glow(1, .1, .2, 1.5), glow(.15, .75, .25, 1.2), glow(.08, .3, 1, 1.5)
for side = -1, 1, 2 do
    local z, number = near, 0
    while z > far + 1 do
        local width, height, floors = dice:range(5, 6.5), dice:range(7, 8.2), 3
        width = math.min(width, z - far)
        number = number + 1
        beside(walls[(number + side) % #walls + 1], side, half, half + 5, 0, height, z - width, z)
        beside(roof, side, half - .5, half + 5, height, height + .22, z - width, z)
        beside(trim, side, half - .05, half, 2.8, 2.92, z - width, z)
        local columns = math.max(1, math.floor(width / 1.6))
        for floor = 0, floors - 1 do
            for column = 1, columns do
                local middle, sill = z - width * (column - .5) / columns, .95 + floor * 2.35
                local pane = dice:range(0, 1) < .8 and dice:pick(warm) or dark
                beside(timber, side, half - .05, half, sill - .08, sill + 1.43, middle - .5, middle + .5)
                beside(pane, side, half - .07, half, sill, sill + 1.35, middle - .42, middle - .03)
                beside(pane, side, half - .07, half, sill, sill + 1.35, middle + .03, middle + .42)
                if pane ~= dark then count = count + 2 end
            end
        end
        z = z - width
    end
end

-- Strings of lanterns across the street, so far from each other that none covers the next.
local row, z = 0, 3.5
local colours = { red, yellow, rose, orange, blue, yellow, red, green }
while z > far + 1 do
    local colour = colours[row % #colours + 1]
    for i = 0, 15 do
        local t = (i + .5) / 16
        lantern(colour, (half - .5) * (2 * t - 1), 5.9 - 3.2 * t * (1 - t), z, .15)
    end
    row, z = row + 1, z - math.max(.9, .0085 * (eye[3] - z) ^ 2)
end

-- Lanterns along the houses and on the kerbs.
for i = 0, 64 do
    for side = -1, 1, 2 do
        local z = near - 1.2 - .55 * i
        lantern(yellow, side * (half - .25), 2.45, z, .15)
        lantern(red, side * (half - .25), 4.8, z, .15)
        lantern(orange, side * (half - .16), .27, z, .14)
        lantern(orange, side * (kerb + .2), .27, z, .14)
    end
end

-- A tower with a gate and a clock closes the street.
local stone = matte(.42, .38, .33)
street:add_child(gr.csg_difference('gate', gr.csg_difference('gateway',
    gr.box { material = stone, min = { -6, 0, far - 2 }, max = { 6, 9.5, far } },
    gr.box { material = stone, min = { -1.5, -1, far - 3 }, max = { 1.5, 2.4, far + 1 } }),
    gr.cylinder { material = stone, from = { 0, 2.4, far - 3 }, to = { 0, 2.4, far + 1 }, radius = 1.5 }))
box(stone, { -2.1, 9.5, far - 2 }, { 2.1, 13.5, far })
street:add_child(gr.cone { material = roof, from = { 0, 18, far - 1 }, to = { 0, 13.5, far - 1 }, from_radius = 0, radius = 3 })
street:add_child(gr.cylinder { material = glow(1, .9, .7, 1), from = { 0, 11.4, far }, to = { 0, 11.4, far + .1 }, radius = 1.1 })
box(dark, { -.08, 11.32, far + .1 }, { .08, 12.2, far + .12 })
box(dark, { -.08, 11.32, far + .1 }, { .6, 11.48, far + .12 })
count = count + 1
for i = 0, 15 do
    lantern(red, .7 * i - 5.25, 4.4, far + .3, .2)
    lantern(yellow, .7 * i - 5.25, 7, far + .3, .2)
end
print(count .. ' lamps')

gr.render {
    node = street, file = 'street.png', width = 480, height = 320, integrator = 'path', denoise = true,
    eye = eye, target = { -.15, 2.7, -10 }, fov = 52, background = { .022, .04, .1 }, tone = 'filmic', filter = 'gaussian',
    exposure = -.3,
}
