-- TITLE: Every shape, group and transform
-- Covers every function that makes a node, with every field: spheres and boxes by both names, cylinders, cones, tori,
-- planes, squares, rectangles, discs, triangles, polygons with holes, paraboloids, hyperboloids, quadrics,
-- superellipsoids, lathes, prisms, sweeps, blobs, curves, patches, height fields, letters, meshes from tables and files by
-- all four names (normals, uvs, smooth, weld, flip, cull, parts), gr.node, gr.joint, gr.instances, gr.geometry, and every
-- transform; node:bounds and node:faces place objects.
-- Author: gray project

local polyhedra = require 'polyhedra'

local count = 0
--- A material with a different colour for each call.
local function paint(two_sided)
    count = count + 1
    local turn = count * 2.4
    return gr.material { kd = { .5 + .3 * math.sin(turn), .5 + .3 * math.sin(turn + 2), .5 + .3 * math.sin(turn + 4) },
        ks = { .3, .3, .3 }, shininess = 30,
        two_sided = two_sided }
end

--- Places objects side by side, four in a row, each scaled to the same size by its bounds.
local function picture(name, things)
    local root = gr.node(name)
    local rows = (#things + 3) // 4
    for k, thing in ipairs(things) do
        local frame = gr.node { name = 'frame', children = { thing } }
        local low, high = frame:bounds()
        local size = math.max(high[1] - low[1], high[2] - low[2], high[3] - low[3])
        frame:translate(-(low[1] + high[1]) / 2, -(low[2] + high[2]) / 2, -(low[3] + high[3]) / 2)
        frame:scale(1.8 / size, 1.8 / size, 1.8 / size)
        frame:rotate('y', 25):rotate('x', 20)
        frame:translate(((k - 1) % 4 - 1.5) * 2.1, ((rows - 1) / 2 - (k - 1) // 4) * 2.1, 0)
        root:add_child(frame)
    end
    root:add_child(gr.plane { normal = { 0, .1, 1 }, distance = -1.6, material = gr.material({ .5, .55, .6 }, { 0, 0, 0 }, 1) })
    gr.render {
        node = root, file = 'shapes-' .. name .. '.png', width = 96, height = 72, eye = { 0, 0, 12 }, fov = 33, ambient = { .2,
            .2, .2 },
        lights = { gr.light({ -4, 6, 9 }, { .8, .8, .75 }), gr.area_light({ 5, 0, 8 }, { 1, 0, 0 }, { 0, 1, 0 }, { .2, .2,
            .3 }, { 1, 0, 0 }) },
        background = 'gradient',
    }
end

picture('solids', {
    gr.sphere(paint()), gr.cube(paint()), gr.nh_sphere(paint(), { 1, 2, 3 }, .5), gr.nh_box(paint(), { 0, 0, 0 }, { -1, .5,
        .8 }),
    gr.cylinder(paint()), gr.cone { material = paint(), from = { 0, 1, 0 }, to = { .3, 0, .2 }, from_radius = .2, radius = .6 },
    gr.geometry('torus', gr.torus('ring', 1, .3)):set_material(paint()), gr.ellipsoid(paint(), { 1, .5, .7 }),
        gr.paraboloid(paint()),
    gr.hyperboloid(paint()), gr.hyperboloid { material = paint(), sheets = 2, gap = .3, height = 1, radius = .7 },
    gr.superellipsoid(paint(), .3, .4),
})
picture('sheets', {
    gr.cylinder { material = paint(true), from = { 0, 0, 0 }, to = { 1, 1, 0 }, radius = .4, open = true },
        gr.cone { material = paint(true), open = true },
    gr.paraboloid { material = paint(true), radius = .8, height = 1.2, open = true }, gr.hyperboloid { material = paint(true),
        waist = .2, radius = .8, open = true },
    gr.square(paint(true)):rotate('x', 60), gr.plane(paint(true)):rotate('x', 40), gr.rectangle(paint(true), { 0, 0, 0 }, { 1,
        0, 0 }, { .3, 1, 0 }),
    gr.disc { material = paint(true), normal = { 1, 1, 1 }, inner = .4 }, gr.triangle(paint(true), { 0, 0, 0 }, { 1, 0, 0 },
        { 0, 1, 0 }),
    gr.polygon(paint(true), { { 0, 0, 0 }, { 4, 0, 0 }, { 2, 1, 0 }, { 4, 4, 0 }, { 0, 4, 0 }, { .5, 2, 0 }, { 1.5, 2, 0 },
        { 1, 3, 0 } },
        { { 0, 1, 2, 3, 4 }, { 5, 6, 7 } }),
    gr.quadric { material = paint(), xx = 1, yy = -1, zz = 1, xy = .4, xz = .3, yz = -.2, x = .1, y = .1, z = -.1,
        constant = -.2, min = { -1, -1, -1 }, max = { 1, 1, 1 } },
    gr.quadric { material = paint(true), xx = 1, yy = 1, zz = -.5, constant = -.3, min = { -1, -1, -1 }, max = { 1, 1, 1 },
        open = true },
})

local wave = { { .2, 0 }, { 1, .3 }, { .4, 1 }, { .8, 1.6 }, { .3, 2 }, { .5, 2.3 }, { .1, 2.5 } }
local leaf = { { 0, 0 }, { 1, -.3 }, { 1.6, .5 }, { 1, 1.2 }, { .2, 1 }, { -.3, .5 } }
local way = { { 0, 0, 0 }, { 1, .5, 0 }, { 1, 1, 1 }, { 0, 1.5, 1 }, { -.5, 1, 0 }, { 0, 2, -.5 }, { .5, 2.2, .3 } }
local pond = {}
for i = 1, 12 do
    pond[i] = {}
    for j = 1, 15 do pond[i][j] = .2 * math.sin(i * j / 9) end
end
local control = {}
for i = 0, 3 do
    for j = 0, 3 do control[#control + 1] = { j, (i - 1.5) * (j - 1.5) * .5 + (i == 1 and 1 or 0), i } end
end
local order, turned_order = {}, {}
for k = 0, 15 do
    order[k + 1], turned_order[k + 1] = k, 4 * (k % 4) + k // 4
end
picture('curves', {
    gr.lathe(paint(), wave, 'catmull-rom'), gr.lathe { material = paint(true), points = wave, open = true },
    gr.lathe { material = paint(), points = { { 1, 0 }, { 1.5, .5 }, { 1, 1 } }, spline = 'b-spline', loop = true },
    gr.prism { material = paint(), outline = leaf, holes = { { { .4, .3 }, { .8, .3 }, { .6, .7 } } }, from = .2, to = .7 },
    gr.prism { material = paint(), outline = leaf, spline = 'bezier' }, gr.sweep(paint(), way, .2, 'linear'),
    gr.sweep { material = paint(), points = way, radii = { .1, .2, .3, .2, .1, .2, .05 }, spline = 'b-spline', loop = true },
    gr.blob { material = paint(), spheres = { { 0, 0, 0, 1 }, { 1, 0, 0, .9, 1.5 }, { .5, .4, .3, .6, -1 } },
        cylinders = { { 0, 0, 0, 0, 1.5, 0, .6, 1 } }, threshold = .4 },
    gr.curve { material = paint(), points = way, widths = { .3, .1, .2, .4, .1, .2, 0 }, spline = 'bezier' },
    gr.curve { material = paint(true), points = way, widths = .2, flat = true },
    gr.patch { material = paint(true), points = control, tolerance = .05, flip = true, patches = { order, turned_order } },
        gr.height_field(paint(), pond),
})

-- meshes: the same twenty faces smooth, flat, reversed, culled, with several materials
local solid, corners = polyhedra.icosahedron()
local normals = {}
for k, corner in ipairs(solid) do normals[k] = { corner[1] + .2, corner[2], corner[3] } end
local face_normals, parts = {}, {}
for k, face in ipairs(corners) do
    face_normals[k] = face
    parts[k] = k % 3 + 1
end
local half = table.move(corners, 1, 12, 1, {})
local own_verts, own_faces = gr.mesh { verts = solid, faces = corners }:faces()
local has_gltf, crate = pcall(gr.mesh, { file = '../../data/models/crate.gltf' })
picture('meshes', {
    gr.mesh(paint(), solid, corners), gr.fast_mesh { material = paint(), verts = solid, faces = corners, smooth = 180 },
    gr.vn_mesh(paint(), solid, normals, corners, face_normals), gr.fast_vn_mesh { material = paint(), verts = solid,
        normals = normals, faces = corners },
    gr.mesh { material = paint(true), verts = solid, faces = half, cull = 'front' }, gr.mesh { material = paint(true),
        verts = solid, faces = half, flip = true, cull = 'back' },
    gr.mesh { verts = own_verts, faces = own_faces, materials = { paint(), paint(), paint() }, face_materials = parts,
        weld = true, smooth = 30 },
    gr.mesh { file = '../../data/models/rocket.obj', smooth = 40, materials = { hull = paint() } },
    gr.mesh { file = '../../data/models/gear.stl', material = paint(), smooth = 25, weld = true },
        gr.mesh { file = '../../data/models/knot.ply', smooth = 180 },
    has_gltf and crate or gr.cube(paint()), gr.height_field { image = '../../textures/bricks_height.png', material = paint(),
        floor = -.4, smooth = true }:scale(1, .1, 1),
})

-- groups: joints, instances, letters, letters of the library, transforms of every kind
local arm = gr.joint('shoulder', { -30, 20, 60 }, { -90, -25, 0 })
arm:add_child(gr.box(paint(), { 0, -.1, -.1 }, { 1, .1, .1 }))
local hand = gr.joint { name = 'hand', x = { 0, 40, 90 }, y = { 0, 70, 90 }, children = { gr.sphere { material = paint(),
    centre = { .5, 0, 0 }, radius = .3 } } }
hand:translate(1, 0, 0)
arm:add_child(hand)
local places = {}
for k = 1, 20 do places[k] = { 3 * math.cos(k), k / 6, 3 * math.sin(k) } end
local matrices = { { 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0 }, { 1, .5, 0, 1, 0, 1, 0, .5, 0, 0, -1, 0 }, { .5, 0, 0, 2, 0, 2, 0,
    0, .3, 0, .5, 0 } }
local has_fonts, word = pcall(gr.glyphs, '../../data/fonts/gray-round.ttf', 'Gy')
local letters = gr.node 'letters'
for k, letter in ipairs(has_fonts and word or {}) do
    if letter.contours[1] then
        local holes = { table.unpack(letter.contours, 2) }
        letters:add_child(gr.prism { material = paint(), outline = letter.contours[1], holes = holes, spline = 'bezier',
            to = .2 }:translate(letter.x, 0, 0):rotate('x', -90))
    end
end
if not has_fonts then letters:add_child(gr.cube(paint())) end
local turned = gr.node 'turned'
for k = 1, 5 do
    local piece = gr.cone(paint())
    piece:scale({ 1, 2.5, .6 }):rotate_axis({ 1, k, 0 }, 30 * k):rotate_quat(.8, .2 * k, 0, .3):translate({ k, 0, k % 2 })
    turned:add_child(piece)
end
turned:rotate_quat { 1, .1, .2, 0 }
local ball = gr.sphere(paint(true))
local group = gr.node { children = { gr.torus { material = paint(), minor = .2 }, gr.cone(paint()) } }
picture('groups', {
    arm, gr.instances(group, places), gr.instances { of = group, at = matrices }, letters, turned,
    gr.clipped_by('open', ball, gr.box { min = { -2, -2, -2 }, max = { .3, .5, 2 } }),
    gr.bounded_by { name = 'hint', object = gr.mesh { material = paint(), verts = solid, faces = corners },
        by = gr.sphere { radius = 3 } },
    gr.instances { of = gr.instances(gr.sphere(paint()), { { 0, 0, 0 }, { 1.5, 1, 0 } }), at = { { 0, 0, 0 }, { 0, -2, 2 },
        { 3, -2, 0 } }, turn = { 0, 45, 90 }, axis = 'x', size = .8 },
})
