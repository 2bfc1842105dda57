-- TITLE: Billiard balls in motion, under lamps of every new kind
-- OPTIONS: -ss 5
-- Author: gray project
--
-- Three balls roll and spin while the shutter is open, with their shadows and mirror images. A ring of
-- light (a mesh that emits) and a clear evening sky are the lamps. After the picture of 1984 by Thomas Porter.

local stage = require 'stage'

local root = gr.node('root')
local radius = 1

local cloth = gr.material { kd = { .05, .30, .16 }, ks = { 0, 0, 0 }, shininess = 1 }
local wood = gr.wood_pnd_material(gr.rr_material({ .30, .14, .06 }, { .25, .25, .25 }, 60, .25, 0, 1), 1, 12, 1,
    { .12, .05, .02 })
root:add_child(stage.box('cloth', cloth, { -14, -1, -9 }, { 14, 0, 9 }))
for _, side in ipairs { -1, 1 } do
    local rail = gr.geometry('rail', gr.cube(wood))
    rail:scale(30, 1.6, 1.4):translate(-15, -.6, side > 0 and 9 or -10.4)
    root:add_child(rail)
end
local rail = gr.geometry('rail', gr.cube(wood))
rail:scale(1.4, 1.6, 21):translate(-15.2, -.6, -10.5)
root:add_child(rail)

local function varnish(colour)
    return gr.rr_material(colour, { .9, .9, .9 }, 300, .12, 0, 1)
end

--- A ball with a white belt, so that its spin is visible.
local function ball(name, colour, belt)
    local solid = gr.sphere { name = name, material = varnish(colour), radius = radius }
    if not belt then
        return solid
    end
    local inside = gr.sphere { name = name .. ' inside', material = varnish(colour), radius = radius }
    local slab = gr.nh_box(name .. ' belt', { -1.2, -.42, -1.2 }, { 2.4, .84, 2.4 })
    slab:set_material(varnish { .92, .90, .84 })
    local middle = gr.intersection { name = name .. ' middle', a = gr.sphere { name = 'round', material =
        varnish { .92, .90, .84 }, radius = radius * 1.0005 }, b = slab }
    local whole = gr.node(name)
    whole:add_child(inside)
    whole:add_child(middle)
    return whole
end

--- Puts a rotated ball on the table; with a displacement it rolls along it while the shutter is open.
local function place(what, x, z, turn, way)
    what:rotate('x', turn[1]):rotate('y', turn[2]):translate(x, radius, z)
    if way then
        local length = math.sqrt(way[1] ^ 2 + way[2] ^ 2)
        local there = gr.node('there')
        there:rotate('x', turn[1]):rotate('y', turn[2])
        -- rolling about the horizontal axis perpendicular to the displacement
        local heading = math.deg(math.atan(way[1], way[2]))
        there:rotate('y', -heading):rotate('x', math.deg(length / radius)):rotate('y', heading)
        there:translate(x + way[1], radius, z + way[2])
        what:moves_to(there)
    end
    root:add_child(what)
end

place(ball('one', { .85, .62, .05 }), -4.6, -2.2, { 0, 0 })
place(ball('nine', { .85, .62, .05 }, true), -1.2, -4.2, { 65, 30 }, { -.8, -.35 })
place(ball('eight', { .02, .02, .025 }), .6, -.6, { 0, 0 })
place(ball('fourteen', { .10, .42, .22 }, true), 3.9, -2.6, { 40, -20 }, { .75, -.7 })
place(ball('cue', { .92, .90, .84 }), -2.6, 1.6, { 0, 0 }, { .7, -.5 })

-- A ring of light above the table.
local glow = gr.material { kd = { 0, 0, 0 }, emission = { 15, 12.6, 9.6 } }
local around, along, verts, faces = 40, 8, {}, {}
for i = 0, around - 1 do
    for k = 0, along - 1 do
        local a, b = 2 * math.pi * i / around, 2 * math.pi * k / along
        local r = 3 + .22 * math.cos(b)
        verts[#verts + 1] = { r * math.cos(a), .22 * math.sin(b), r * math.sin(a) }
        local i1, k1 = (i + 1) % around, (k + 1) % along
        faces[#faces + 1] = { i * along + k, i * along + k1, i1 * along + k1, i1 * along + k }
    end
end
local ring = gr.mesh { name = 'ring', material = glow, verts = verts, faces = faces }
ring:translate(0, 8.5, -2)
root:add_child(ring)

local sky = gr.clear_sky { sun = { -1, .12, .4 }, turbidity = 4, intensity = .8, ground = { .05, .035, .03 } }
gr.render { node = root, file = 'light.png', width = 640, height = 400,
    eye = { .8, 4.9, 10.2 }, target = { -.3, .8, -1.4 }, fov = 36, ambient = { .01, .01, .012 },
    lights = { gr.mesh_light { mesh = ring, samples = 1 }, gr.sky_light { sky = sky, samples = 2 } },
    background = sky, shutter = { 0, 1 }, reflect_limit = 3, srgb = true, tone = 'filmic' }
