-- TITLE: Images and relief on every shape with coordinates
-- Covers gr.texture, gr.image_material, node:set_texture, gr.bump, gr.bump_material and node:set_bump on spheres, cubes,
-- cylinders, cones, tori, discs, squares, rectangles, triangles, meshes with uvs, height fields, planes and instances;
-- filters, wraps, tiles, offsets and flips; colour PNG, palette, transparency and JPEG; bump and normal maps from none to
-- extreme heights, on smooth, flat and scaled shapes.
-- Author: gray project

local textures = '../../textures/'
local plain = gr.material({ .75, .75, .75 }, { .3, .3, .3 }, 25)

--- New shapes with coordinates, each about as large as a unit ball.
local function shapes()
    local verts = { { -.9, -.9, 0 }, { .9, -.9, 0 }, { .9, .9, .3 }, { -.9, .9, -.3 }, { 0, 0, .7 } }
    local uvs = { { 0, 0 }, { 2, 0 }, { 2, 2 }, { 0, 2 }, { 1, 1 } }
    local faces = { { 0, 1, 4 }, { 1, 2, 4 }, { 2, 3, 4 }, { 3, 0, 4 } }
    local heights = {}
    for i = 1, 6 do
        heights[i] = {}
        for j = 1, 6 do heights[i][j] = .15 * math.sin(i) * math.cos(j) end
    end
    return {
        gr.sphere {},
        gr.cube {}:translate(-.5, -.5, -.5):scale(1.5, 1.5, 1.5):rotate('y', 35):rotate('x', 25),
        gr.cylinder { radius = .7, open = true }:scale(1, .9, 1):rotate('x', 30),
        gr.cone { from = { 0, 1, 0 }, to = { 0, -1, 0 }, radius = .9, from_radius = .2 }:rotate('x', 20),
        gr.torus { major = .7, minor = .3 }:rotate('x', 60),
        gr.disc { normal = { 0, .3, 1 }, inner = .3 },
        gr.square {}:scale(1.8, 1.8, 1.8):rotate('x', 70),
        gr.rectangle { corner = { -.9, -.8, 0 }, along = { 1.6, 0, .4 }, up = { .4, 1.6, 0 } },
        gr.triangle { a = { -1, -.8, 0 }, b = { 1, -.8, .3 }, c = { 0, 1, 0 } },
        gr.mesh { verts = verts, faces = faces, uvs = uvs },
        gr.mesh { verts = verts, faces = faces, uvs = uvs, face_uvs = { { 0, 1, 2 }, { 0, 1, 2 }, { 1, 2, 3 }, { 0, 1, 2 } },
            smooth = 180 },
        gr.height_field { heights = heights, smooth = true }:translate(-.5, 0, -.5):scale(1.8, 1.8, 1.8):rotate('x', 60),
    }
end

--- Twelve shapes in three rows, with materials from a function.
local function picture(name, dress)
    local root = gr.node(name)
    for k, shape in ipairs(shapes()) do
        local place = gr.node 'place'
        shape:set_material(plain)
        dress(shape, k)
        place:add_child(shape)
        place:translate(((k - 1) % 4 - 1.5) * 2.2, (1 - (k - 1) // 4) * 2.2, 0)
        root:add_child(place)
    end
    gr.render {
        node = root, file = 'images-' .. name .. '.png', width = 96, height = 72, eye = { 0, 0, 12 }, fov = 32, ambient = { .2,
            .2, .2 },
        background = { .3, .35, .45 }, lights = { gr.light({ -6, 6, 8 }, { .8, .8, .75 }), gr.light({ 7, -2, 6 }, { .2, .2,
            .3 }) },
    }
end

picture('plain', function(shape) shape:set_texture(textures .. 'checker.png') end)

local filters, wraps = { 'nearest', 'bilinear', 'mipmap' }, { 'clamp', 'repeat', 'mirror' }
local files = { textures .. 'label.png', textures .. 'star.png', '../fuzz/corpus/jpeg/base.jpg', textures .. 'earth.png',
    '../fuzz/corpus/jpeg/gray.jpg',
    textures .. 'painting.png', '../fuzz/corpus/jpeg/prog.jpg' }
picture('fields', function(shape, k)
    shape:set_texture(gr.texture { file = files[k % #files + 1], filter = filters[k % 3 + 1], wrap = wraps[k // 3 % 3 + 1],
        flip_u = k % 4 < 2,
        tiles = { 1 + k % 3, .5 + k % 2 }, offset = { .1 * k, -.3 } })
end)

picture('materials', function(shape, k)
    local image = gr.texture { file = files[(3 * k) % #files + 1], filter = filters[k % 3 + 1], tiles = k % 2 + 1,
        offset = .25 }
    shape:set_material(gr.image_material { material = plain, image = image, wrap = wraps[k % 3 + 1], tiles = 1.5, offset = { 0,
        .5 },
        flip_u = k % 2 == 0, channel = k % 5 == 0 and 'emission' or 'kd' })
end)

local heights = { .01, .1, 1, 30, -.1, -5, 0, 1e-6, 1e4, .05, .3, -1e5 }
picture('bumps', function(shape, k)
    shape:set_bump(gr.bump { file = textures .. 'bricks_height.png', height = heights[k], tiles = { 2, 1 + k % 2 },
        filter = filters[k % 3 + 1],
        flip_u = k % 2 == 0 })
end)

local slopes = { 1, .2, 5, 1000, -1, 0, -50, 2, .7, 1e5, 3, 1 }
picture('normals', function(shape, k)
    local map = gr.bump { file = textures .. 'weave_normal.png', kind = 'normal', height = slopes[k], tiles = 2 + k % 2,
        offset = { .2, .1 * k },
        wrap = wraps[k % 3 + 1] }
    if k % 2 == 0 then shape:set_bump(map) else shape:set_material(gr.bump_material(plain, map)) end
end)

-- bump maps under images, over bump maps, as a file name, on mirrors and on unevenly scaled shapes
local mirror = gr.rr_material({ .2, .2, .2 }, { .8, .8, .8 }, 80, .6, 0, 1)
picture('both', function(shape, k)
    if k % 4 == 0 then
        shape:set_texture(textures .. 'tiles.png')
        shape:set_bump(textures .. 'bricks_height.png')
    elseif k % 4 == 1 then
        shape:set_material(gr.bump_material(mirror, textures .. 'weave_normal.png', .3))
    elseif k % 4 == 2 then
        shape:set_material(gr.bump_material { material = gr.bump_material(plain, gr.bump(textures .. 'bricks_height.png', .2)),
            image = textures .. 'weave_normal.png', kind = 'normal', tiles = 3, filter = 'nearest', wrap = 'mirror',
                offset = .5, flip_u = true })
        shape:scale(1, .5, 1.5)
    else
        shape:set_material(gr.image_material(gr.bump_material { material = mirror, image = textures .. 'earth.png',
            height = -.4 }, textures .. 'rug.png'))
        shape:scale(-.6, 1, .8)
    end
end)
