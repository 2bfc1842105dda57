-- TITLE: Radiosity: a flight through a room that is solved once
-- The sun falls through a window on a red carpet, whose light colours the wall and the ceiling. The light of all
-- surfaces is stored before the first frame; the other frames show it from other eyes.
-- Author: gray project

local room = gr.node('room')

local function matte(r, g, b)
    return gr.material { kd = { r, g, b }, two_sided = true }
end
local white, floor, carpet = matte(.8, .78, .74), matte(.5, .36, .22), matte(.7, .15, .08)
local wood, blue = matte(.5, .3, .14), matte(.15, .3, .6)

local function wall(material, corner, along, up)
    room:add_child(gr.rectangle { material = material, corner = corner, along = along, up = up })
end
local function block(material, from, to)
    room:add_child(gr.box { material = material, min = from, max = to })
end

-- 6 x 3 x 5; the left wall has a window between y = .8 and 2.4 and z = -3.6 and -1.6.
wall(floor, { 0, 0, 0 }, { 6, 0, 0 }, { 0, 0, -5 })
wall(white, { 0, 3, 0 }, { 6, 0, 0 }, { 0, 0, -5 })
wall(white, { 0, 0, -5 }, { 6, 0, 0 }, { 0, 3, 0 })
wall(white, { 0, 0, 0 }, { 6, 0, 0 }, { 0, 3, 0 })
wall(blue, { 6, 0, 0 }, { 0, 0, -5 }, { 0, 3, 0 })
room:add_child(gr.polygon {
    material = white, outlines = { { 0, 1, 2, 3 }, { 4, 5, 6, 7 } },
    points = { { 0, 0, 0 }, { 0, 0, -5 }, { 0, 3, -5 }, { 0, 3, 0 }, { 0, .8, -1.6 }, { 0, .8, -3.6 }, { 0, 2.4, -3.6 }, { 0, 2.4, -1.6 } },
})
-- The sill, and the bar in the middle.
block(white, { -.15, .74, -3.65 }, { .2, .8, -1.55 })
block(white, { -.05, .8, -2.64 }, { .03, 2.4, -2.56 })

block(carpet, { .9, 0, -3.9 }, { 3.5, .02, -1.5 })

-- A table with a ball and a mirror ball, and a shelf.
block(wood, { 3.2, .7, -3.6 }, { 4.8, .76, -2.4 })
for _, x in ipairs { 3.25, 4.67 } do
    for _, z in ipairs { -3.55, -2.53 } do
        block(wood, { x, 0, z }, { x + .08, .7, z + .08 })
    end
end
room:add_child(gr.sphere { material = matte(.75, .6, .1), centre = { 3.7, .96, -2.8 }, radius = .2 })
room:add_child(gr.sphere {
    material = gr.material { kd = { 0, 0, 0 }, ks = { .9, .9, .9 }, reflect = .9 }, centre = { 4.3, 1.01, -3.1 }, radius = .25,
})
block(wood, { 5.6, 0, -4.6 }, { 6, 1.8, -3.6 })

local sun = gr.directional_light({ .72, -.6, .12 }, { 5, 4.6, 3.9 })
local path = gr.keys {
    curve = 'catmull',
    { 0, { eye = { 5.5, 1.7, -.5 }, target = { 2.2, .9, -3 } } },
    { .5, { eye = { 3, 1.5, -.4 }, target = { 2.6, .9, -3.2 } } },
    { 1, { eye = { .6, 1.6, -.9 }, target = { 4, .8, -3.2 } } },
}

gr.frames {
    count = 16, fps = 10,
    draw = function(t)
        local show = path(t)
        show.node, show.width, show.height, show.fov = room, 240, 150, 66
        show.integrator, show.radiosity_patches = 'radiosity', 12000
        show.lights, show.background, show.exposure = { sun }, { .55, .75, 1 }, .7
        return show
    end,
}
