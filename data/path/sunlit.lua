-- TITLE: A room in the morning sun
-- OPTIONS: --spp 72
-- The sun and the clear sky shine through one window; everything else is lit by light that comes back from the floor
-- and the walls.
local function matte(r, g, b) return gr.material { kd = { r, g, b }, two_sided = true } end
local room = gr.node('room')
local function box(material, min, max) room:add_child(gr.box { material = material, min = min, max = max }) end

local plaster, ceiling, white = matte(.78, .76, .71), matte(.82, .81, .79), matte(.8, .79, .77)
local oak = gr.openpbr_material { base_color = { .48, .3, .16 }, specular_roughness = .35 }
local dark = matte(.16, .1, .07)
-- Boards of 16 by 130 centimetres.
local function boards(p)
    local row = math.floor(p.x / .16)
    local board = math.floor(p.z / 1.3 + gr.hash(row, 0, 0))
    local grain = gr.noise(p.x * 60, 7 * row, p.z * 4)
    return gr.mix({ .42, .26, .13 }, { .62, .43, .25 }, gr.clamp(gr.hash(row, board, 1) + .15 * grain, 0, 1))
end
local floor = gr.openpbr_material { base_color = gr.fn(boards, 1), specular_roughness = .3 }

-- The shell: a wall with a window on the left, and the side behind the camera, which is open to a terrace. A unit is a
-- metre.
room:add_child(gr.rectangle { material = floor, corner = { -2.7, 0, 3.3 }, along = { 5.3, 0, 0 }, up = { 0, 0, -6.6 } })
box(plaster, { -2.7, -.1, -3.3 }, { 2.7, 2.8, -3.1 })
box(plaster, { 2.4, -.1, -3.2 }, { 2.6, 2.8, 3.3 })
box(ceiling, { -2.7, 2.7, -3.3 }, { 2.7, 2.9, 3.4 })
local west, z0, z1, y0, y1 = -2.4, -2.4, .2, .45, 2.4
box(plaster, { west - .25, -.1, -3.2 }, { west, 2.8, z0 })
box(plaster, { west - .25, -.1, z1 }, { west, 2.8, 3.3 })
box(plaster, { west - .25, -.1, z0 }, { west, y0, z1 })
box(plaster, { west - .25, y1, z0 }, { west, 2.8, z1 })
box(white, { west - .22, y0 - .03, z0 - .06 }, { west + .1, y0 + .01, z1 + .06 })
for i = 0, 3 do
    local z = z0 + (z1 - z0 - .05) * i / 3
    box(white, { west - .17, y0, z }, { west - .11, y1, z + .05 })
end
for i = 0, 2 do
    local y = y0 + (y1 - y0 - .05) * i / 2
    box(white, { west - .165, y, z0 }, { west - .115, y + .05, z1 })
end
box(white, { -2.4, 0, -3.1 }, { 2.4, .12, -3.085 })
box(white, { 2.385, 0, -3.1 }, { 2.4, .12, 3.2 })

-- A table with two stools.
box(oak, { -.7, .7, -1.75 }, { .9, .745, -.75 })
for _, x in ipairs { -.62, .76 } do
    for _, z in ipairs { -1.68, -.88 } do box(oak, { x, 0, z }, { x + .06, .7, z + .06 }) end
end
local function stool(x, z, degrees)
    local all = gr.node('stool')
    all:add_child(gr.cylinder { material = oak, from = { 0, .43, 0 }, to = { 0, .46, 0 }, radius = .19 })
    for i = 0, 2 do
        local a = 2 * math.pi * i / 3
        all:add_child(gr.cylinder { material = dark, from = { .1 * math.cos(a), .44, .1 * math.sin(a) },
            to = { .17 * math.cos(a), 0, .17 * math.sin(a) }, radius = .016 })
    end
    all:rotate('y', degrees)
    all:translate(x, 0, z)
    room:add_child(all)
end
stool(-.35, -.35, 20)
stool(1.25, -1.3, 75)

-- On the table: a bowl with oranges, a vase, books.
local glaze = gr.openpbr_material { base_color = { .75, .76, .72 }, coat_weight = 1, specular_roughness = .25 }
local bowl = gr.csg_difference('bowl', gr.csg_intersection('below', gr.sphere { material = glaze,
    centre = { .1, 1, -1.3 }, radius = .24 }, gr.box { material = glaze, min = { -.3, .745, -1.6 }, max = { .5, .9, -1 } }),
    gr.sphere { material = glaze, centre = { .1, 1, -1.3 }, radius = .225 })
room:add_child(bowl)
local orange = gr.openpbr_material { base_color = { .85, .36, .04 }, specular_roughness = .4 }
for _, p in ipairs { { .03, .835, -1.3 }, { .15, .838, -1.36 }, { .14, .833, -1.24 }, { .1, .905, -1.3 } } do
    room:add_child(gr.sphere { material = orange, centre = p, radius = .058 })
end
local vase = gr.openpbr_material { base_color = { .07, .18, .36 }, coat_weight = 1, specular_roughness = .3 }
room:add_child(gr.cone { material = vase, from = { -.4, .745, -1.5 }, to = { -.4, 1.0, -1.5 }, from_radius = .08, radius = .05 })
local lip = gr.torus { material = vase, major = .05, minor = .009 }
lip:translate(-.4, 1, -1.5)
room:add_child(lip)
box(matte(.5, .09, .07), { .5, .745, -1.2 }, { .72, .785, -.9 })
box(matte(.1, .22, .2), { .52, .785, -1.18 }, { .73, .815, -.92 })

-- A shelf, a picture and a sofa.
box(dark, { 1.2, 0, -3.09 }, { 2.2, 1.7, -3.06 })
for i = 0, 4 do box(oak, { 1.2, .03 + .41 * i, -3.09 }, { 2.2, .06 + .41 * i, -2.8 }) end
for i = 0, 1 do box(oak, { 1.17 + 1.03 * i, 0, -3.09 }, { 1.2 + 1.03 * i, 1.73, -2.8 }) end
local covers = { matte(.45, .1, .08), matte(.1, .2, .34), matte(.5, .42, .25), matte(.14, .26, .16), matte(.55, .52, .46) }
local dice = require('random').new(3)
for level = 0, 3 do
    local x = 1.22
    while x < 2.1 do
        local thick, tall = dice:range(.025, .05), dice:range(.22, .34)
        box(dice:pick(covers), { x, .06 + .41 * level, -3.05 }, { x + thick * .95, .06 + .41 * level + tall, -2.86 })
        x = x + thick + (dice:range(0, 1) < .1 and .08 or 0)
    end
end
box(dark, { -.9, 1.15, -3.1 }, { .5, 2.05, -3.07 })
room:add_child(gr.rectangle { corner = { -.85, 1.2, -3.065 }, along = { 1.3, 0, 0 }, up = { 0, .8, 0 },
    material = gr.material { kd = gr.texture { file = 'painting.png' }, two_sided = true } })
local cloth = gr.openpbr_material { base_color = { .3, .36, .3 }, fuzz_weight = .5, fuzz_color = { .6, .65, .6 },
    specular_weight = 0 }
local function cushion(min, max)
    local node = gr.superellipsoid { material = cloth, e = .25, n = .25 }
    node:scale((max[1] - min[1]) / 2, (max[2] - min[2]) / 2, (max[3] - min[3]) / 2)
    node:translate((max[1] + min[1]) / 2, (max[2] + min[2]) / 2, (max[3] + min[3]) / 2)
    room:add_child(node)
end
box(dark, { 1.4, .05, -2.3 }, { 2.3, .13, .3 })
cushion({ 1.3, .12, -2.2 }, { 2.3, .44, -1 })
cushion({ 1.3, .12, -1 }, { 2.3, .44, .2 })
cushion({ 2.05, .4, -2.2 }, { 2.35, .85, -1 })
cushion({ 2.05, .4, -1 }, { 2.35, .85, .2 })
cushion({ 1.3, .1, -2.42 }, { 2.35, .62, -2.2 })
cushion({ 1.3, .1, .2 }, { 2.35, .62, .42 })

local sun = { -.62, .52, -.12 }
gr.render {
    node = room, file = 'sunlit.png', width = 400, height = 300, integrator = 'path', denoise = true,
    eye = { -1.2, 1.45, 2.9 }, target = { .25, .95, -2 }, fov = 52, tone = 'filmic', exposure = 1,
    background = gr.clear_sky { sun = sun, turbidity = 3 },
    lights = { gr.sun_light { sun = sun, colour = { 2.6, 2.3, 1.9 } } },
}
