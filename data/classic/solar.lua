-- TITLE: Solar system
-- Planets on their orbits as a chain of nodes, with a textured earth and a ringed giant.
-- Author: gray project. Dialect: project.

local sweep = require 'sweep'

local root = gr.node('system')

local function circle(radius, n)
    local path = {}
    for i = 1, n do
        local a = 2 * math.pi * i / n
        path[i] = { radius * math.cos(a), 0, radius * math.sin(a) }
    end
    return path
end

-- the sun is bright by its own colour: above white under ambient light alone
local sun = gr.geometry('sun', gr.sphere(gr.material({ 6, 4.6, 2 }, { 0, 0, 0 }, 1)))
sun:scale(1.1, 1.1, 1.1)
root:add_child(sun)

local orbit_line = gr.material({ .5, .5, .6 }, { 0, 0, 0 }, 1)
local planets = {
    { 2.0, .16, 40, gr.material({ .6, .55, .5 }, { .1, .1, .1 }, 10) },
    { 2.9, .28, 200, gr.material({ .85, .7, .45 }, { .2, .2, .2 }, 10) },
    { 4.1, .36, 305, gr.marble_pnd_material(gr.material({ .15, .3, .75 }, { .3, .3, .3 }, 30), 2.5, 5, 2, 1, { .9, .95, 1 }) },
    { 5.2, .24, 120, gr.material({ .75, .35, .2 }, { .1, .1, .1 }, 10) },
    { 7.2, .75, 250, gr.marble_pnd_material(gr.material({ .8, .65, .5 }, { .1, .1, .1 }, 10), 1.2, 1.5, 11, 1, { .6, .4, .3 }) },
}
for k, planet in ipairs(planets) do
    local distance, size, angle, material = table.unpack(planet)
    root:add_child(gr.geometry('orbit', gr.vn_mesh(orbit_line, sweep.tube(circle(distance, 96), .012, 6, { closed = true }))))
    local year = gr.node('year ' .. k)
    local here = gr.node('here')
    local globe = gr.geometry('globe', gr.sphere(material))
    globe:rotate('y', 150)
    globe:rotate('z', 20)
    globe:scale(size, size, size)
    here:add_child(globe)
    if k == 3 then
        local moon = gr.geometry('moon', gr.sphere(gr.material({ .6, .6, .6 }, { 0, 0, 0 }, 1)))
        moon:scale(.09, .09, .09)
        moon:translate(.6, .1, 0)
        here:add_child(moon)
    elseif k == 5 then
        local ring = gr.geometry('ring', gr.vn_mesh(gr.material({ .7, .6, .5 }, { .1, .1, .1 }, 5),
            sweep.tube(circle(1.25, 80), .14, 12, { closed = true })))
        ring:scale(1, .06, 1)
        ring:rotate('x', 18)
        ring:rotate('z', -10)
        here:add_child(ring)
    end
    here:translate(distance, 0, 0)
    year:add_child(here)
    year:rotate('y', angle)
    root:add_child(year)
end

gr.render {
    node = root, file = 'solar.png', width = 480, height = 320, eye = { 0, 5.2, 13 }, view = { 0, -.38, -1 }, fov = 46,
    ambient = { .16, .16, .18 }, background = { .01, .01, .03 },
    lights = { gr.light({ 0, 1.6, 0 }, { .9, .85, .7 }, { 1, 0, 0 }), gr.light({ 0, 6, 16 }, { .35, .35, .4 }, { 1, 0, 0 }) },
}
