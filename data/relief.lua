-- TITLE: Relief by pictures
-- Bump maps and a normal map on shapes with uv; leaves cut out of cards by an opacity map.
-- Author: gray project

local folder = '../textures/'

local function clay(kd) return gr.openpbr_material { base_color = kd, specular_roughness = .45 } end
local function bricks(tiles, height)
    return gr.bump { file = folder .. 'bricks_height.png', tiles = tiles, height = height }
end
local function weave(tiles, strength)
    return gr.bump { file = folder .. 'weave_normal.png', kind = 'normal', tiles = tiles, height = strength }
end

local scene = gr.node('relief')

-- a wall and a floor
scene:add_child(gr.rectangle { corner = { -9.33, 0, -3.4 }, along = { 18.67, 0, 0 }, up = { 0, 7, 0 }, material = clay { .42, .17, .10 } }
    :set_bump(bricks({ 8, 3 }, .09)))
scene:add_child(gr.rectangle { corner = { -9.33, 0, 6 }, along = { 18.67, 0, 0 }, up = { 0, 0, -9.4 }, material = clay { .30, .25, .18 } }
    :set_bump(weave({ 12, 6 }, .8)))

-- the same image on all shapes with texture coordinates
local shapes = {
    { gr.sphere {}, { 6, 3 }, { .62, .58, .50 } },
    { gr.cylinder { from = { 0, -1, 0 }, to = { 0, 1, 0 }, radius = .8 }, { 4, 1 }, { .16, .26, .33 } },
    { gr.torus { major = .8, minor = .35 }:rotate('x', 65), { 6, 2 }, { .58, .36, .10 } },
    { gr.cube {}:translate(-.5, -.5, -.5):scale(1.5, 1.5, 1.5):rotate('y', 35), { 1, 1 }, { .20, .27, .14 } },
    { gr.cone { from = { 0, 1, 0 }, to = { 0, -1, 0 }, radius = 1 }, { 4, 1 }, { .40, .16, .15 } },
}
for k, entry in ipairs(shapes) do
    local place = gr.node('place')
    local shape = entry[1]
    shape:set_material(clay(entry[3]))
    shape:set_bump(k % 2 == 1 and bricks(entry[2], .05) or weave(entry[2], 1))
    place:add_child(shape)
    place:translate(2.45 * (k - 3), k == 4 and .75 or 1, k % 2 == 1 and -.6 or .7)
    scene:add_child(place)
end

-- cards with leaves cut out of them
local green = gr.material { kd = { .42, .16, .035 }, ks = { .1, .1, .1 }, shininess = 20, two_sided = true }
local leaf = gr.image_material { material = green, image = folder .. 'leaves_mask.png', channel = 'opacity' }
for k = 0, 6 do
    scene:add_child(gr.rectangle { corner = { -.6, 0, .6 }, along = { 1.2, 0, 0 }, up = { 0, .22, -1.2 }, material = leaf }
        :rotate('y', 52 * k):translate(-5.1 + 1.7 * k, .02 + .03 * (k % 3), 2.9 + .5 * (k % 2)))
end

gr.render {
    node = scene, file = 'relief.png', width = 800, height = 450, eye = { 0, 3.1, 11 }, target = { 0, 1.1, 0 }, fov = 33,
    integrator = 'path', spp = 8, denoise = true, tone = 'filmic', exposure = 0.3, background = { .10, .13, .19 },
    lights = { gr.spherical_light { position = { -7, 6.5, 6.5 }, radius = 0.7, colour = { 1, .85, .64 }, emission = { 110, 110, 110 } } },
}
