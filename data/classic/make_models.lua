-- TITLE: The models of these scenes
-- Writes cow.obj, hat.obj, carrot.obj, hand.obj and arch.obj beside itself. Run: lua5.4 data/classic/make_models.lua
-- Author: gray project

local here = (debug.getinfo(1, 'S').source:match('^@(.*/)') or './')
package.path = here .. '../../lua/?.lua;' .. package.path

local meshes = require 'meshes'
local polyhedra = require 'polyhedra'
local lathe = require 'lathe'
local sweep = require 'sweep'

local function write(name, title, mesh)
    local verts, faces = meshes.weld(mesh[1], mesh[3], 1e-5)
    local handle = assert(io.open(here .. name, 'w'))
    handle:write(meshes.to_obj({ verts, nil, faces }, title .. ' (gray project)'))
    handle:close()
end

-- A cow, four feet on y = 0, looking along +x, about 3.4 long: pushed and pulled spheres.
local function blob(detail, sx, sy, sz, x, y, z, tilt)
    local mesh = meshes.scale({ polyhedra.geodesic(detail) }, sx, sy, sz)
    if tilt then mesh = meshes.rotate(mesh, 'z', tilt) end
    return meshes.translate(mesh, x, y, z)
end

local parts = {
    blob(3, 1.25, .62, .56, 0, 1.55, 0), blob(2, .52, .58, .52, .85, 1.58, 0), blob(2, .55, .60, .54, -.80, 1.55, 0),
    blob(2, .62, .34, .27, 1.38, 1.92, 0, 40), blob(3, .50, .30, .27, 1.85, 2.18, 0, -28), blob(2, .20, .17, .21, 2.20, 2.00, 0),
    blob(2, .26, .20, .24, -.60, 1.02, 0),
}
for _, z in ipairs { -1, 1 } do
    for _, x in ipairs { -.85, .85 } do
        parts[#parts + 1] = meshes.translate({ lathe.turn(lathe.spline({ { 0, 0 }, { .15, 0 }, { .16, .12 }, { .11, .18 },
            { .10, .55 }, { .16, .85 }, { .24, 1.35 }, { 0, 1.5 } }, 3), 14) }, x, 0, z * .30)
    end
    parts[#parts + 1] = { sweep.tube({ { 1.72, 2.38, z * .14 }, { 1.72, 2.50, z * .28 }, { 1.78, 2.66, z * .36 },
        { 1.88, 2.80, z * .34 } }, .07, 10, { scale = function(t) return 1 - .85 * t end }) }
    parts[#parts + 1] = meshes.translate(meshes.rotate(meshes.scale({ polyhedra.geodesic(2) }, .08, .13, .22), 'x', z * 50), 1.62, 2.27, z * .36)
end
parts[#parts + 1] = { sweep.tube({ { -1.28, 1.85, 0 }, { -1.48, 1.72, 0 }, { -1.54, 1.3, .02 }, { -1.52, .85, .03 } }, .045, 10) }
parts[#parts + 1] = blob(1, .09, .18, .09, -1.52, .75, .03)
write('cow.obj', 'a cow', meshes.merge(parts))

write('hat.obj', 'a hat, brim at y = 0', { lathe.turn({ { 0, 0 }, { 1.5, 0 }, { 1.5, 0 }, { 1.5, .1 }, { 1.5, .1 }, { .92, .1 },
    { .92, .1 }, { 1.0, 1.5 }, { 1.0, 1.5 }, { 0, 1.5 } }, 40) })
write('carrot.obj', 'a carrot along +z', meshes.rotate({ lathe.turn(lathe.spline({ { 0, 0 }, { .16, 0 }, { .13, .4 }, { .12, .45 },
    { .06, .85 }, { 0, 1 } }, 4), 20) }, 'x', 90))

-- the hand of a clock: points to +y, one long, as one concave outline with a front and a back
local outline = { { -.05, -.2 }, { .05, -.2 }, { .04, .60 }, { .13, .66 }, { 0, 1 }, { -.13, .66 }, { -.04, .60 } }
local verts, faces, n = {}, {}, #outline
for _, z in ipairs { .02, -.02 } do
    for _, p in ipairs(outline) do verts[#verts + 1] = { p[1], p[2], z } end
end
local front, back = {}, {}
for i = 1, n do
    front[i], back[i] = i - 1, 2 * n - i
    local j = i % n + 1
    faces[#faces + 1] = { i - 1, n + i - 1, n + j - 1, j - 1 }
end
faces[#faces + 1], faces[#faces + 2] = front, back
write('hand.obj', 'the hand of a clock', { verts, nil, faces })

-- an arch of stones: from x = -1.2 to 1.2, 2.2 high
local stones = {}
local function stone(a, b, depth)
    local v = {}
    for _, z in ipairs { depth, -depth } do
        for _, p in ipairs { { a, .8 }, { b, .8 }, { b, 1.2 }, { a, 1.2 } } do
            v[#v + 1] = { -p[2] * math.cos(p[1]), 1 + p[2] * math.sin(p[1]), z }
        end
    end
    local f = { { 0, 1, 2, 3 }, { 7, 6, 5, 4 }, { 4, 5, 1, 0 }, { 5, 6, 2, 1 }, { 6, 7, 3, 2 }, { 7, 4, 0, 3 } }
    stones[#stones + 1] = { v, nil, f }
end
for k = 0, 8 do stone(math.pi * (k + .04) / 9, math.pi * (k + .96) / 9, k == 4 and .28 or .24) end
for _, x in ipairs { -1, 1 } do
    for k = 0, 2 do
        local v, f = polyhedra.box({ x - .2, k / 3 + .01, -.24 }, { x + .2, (k + 1) / 3 - .01, .24 })
        stones[#stones + 1] = { v, nil, f }
    end
end
write('arch.obj', 'an arch', meshes.merge(stones))
