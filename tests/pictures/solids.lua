-- TITLE: Solids cut and joined
-- Covers gr.union, gr.difference, gr.intersection, gr.merge and gr.inverse, their names with csg_, any number of operands,
-- groups and nested, transformed and mirrored operands, meshes, half-spaces, blobs, prisms, instances of solids, operands
-- of different materials (glass, mirrors, images, relief, holes), gr.clipped_by and gr.bounded_by; fog inside of them.
-- Author: gray project

local polyhedra = require 'polyhedra'
local textures = '../../textures/'

local function matt(r, g, b) return gr.material({ r, g, b }, { .3, .3, .3 }, 30) end
local red, green, blue, white = matt(.8, .25, .2), matt(.3, .7, .3), matt(.25, .35, .8), matt(.8, .8, .8)
local mirror = gr.rr_material({ .1, .1, .1 }, { .9, .9, .9 }, 100, .8, 0, 1)
local glass = gr.difresnel_material(gr.rr_material { kd = { 0, 0, 0 }, ks = { .95, .95, .95 }, shininess = 100, reflect = 1,
    refract = 1, ior = 1.5,
    absorption = { .5, .1, .3 } })

local function ball(material, x, y, z, radius) return gr.sphere { material = material, centre = { x, y, z },
    radius = radius or 1 } end
local function block(material, size) return gr.box(material, { -size, -size, -size }, { size, size, size }) end

local function picture(name, things, fields)
    local root = gr.node(name)
    local rows = (#things + 2) // 3
    for k, thing in ipairs(things) do
        local place = gr.node 'place'
        place:add_child(thing)
        place:rotate('y', 30):rotate('x', 25):translate(((k - 1) % 3 - 1) * 3, ((rows - 1) / 2 - (k - 1) // 3) * 3, 0)
        root:add_child(place)
    end
    root:add_child(gr.plane { normal = { 0, 0, 1 }, distance = -2.5, material = gr.image_material { tiles = .5,
        image = textures .. 'tiles.png', material = white } })
    fields = fields or {}
    fields.node, fields.file, fields.width, fields.height, fields.eye, fields.fov = root, 'solids-' .. name .. '.png', 96, 72,
        { 0, 0, 14 }, 33
    fields.ambient, fields.lights = { .25, .25, .25 }, { gr.light({ -5, 7, 9 }, { .7, .7, .65 }), gr.light({ 6, 1, 12 }, { .2,
        .2, .25 }) }
    gr.render(fields)
end

picture('names', {
    gr.union('two', ball(red, -.5, 0, 0, .8), ball(green, .5, 0, 0, .8)), gr.csg_difference('bitten', block(white, .8),
        ball(red, .8, .8, .8, .8)),
    gr.intersection('lens', ball(red, -.4, 0, 0), ball(green, .4, 0, 0), ball(blue, 0, 0, .5)),
    gr.merge { a = ball(glass, -.4, 0, 0, .8), b = ball(glass, .4, .2, 0, .8) }, gr.csg_union { ball(glass, 0, 0, 0, .8),
        block(red, .5) },
    gr.csg_intersection { name = 'more', a = block(blue, .8), b = ball(mirror, 0, 0, 0), operands = { gr.inverse('not',
        ball(green, 0, 0, .9, .5)) } },
    gr.difference('holes', block(white, .8), gr.cylinder(red):scale(.4, 2, .4), gr.cylinder(green):scale(.3, 2, .3):rotate('x',
        90),
        gr.cylinder(blue):scale(.2, 2, .2):rotate('z', 90)),
    gr.csg_merge('merged', gr.cone(red), gr.torus('ring', .8, .2):set_material(mirror)), gr.intersection('rest', block(green,
        .9), gr.csg_inverse('out', ball(white, 0, 0, 0, 1.1))),
})

-- nested, scaled unevenly and mirrored, with groups as operands
local solid = gr.difference('cut', block(red, .7), ball(white, .7, .7, .7, .7))
local group = gr.node { children = { ball(blue, -.5, .2, 0, .5), ball(green, .4, 0, .3, .5), gr.cube(white):translate(-.2, -.8,
    -.2) } }
local turned = gr.node { children = { solid } }
turned:scale(-1, .6, 1.4):rotate('z', 40)
local deep = ball(white, 0, 0, 0)
for k = 1, 6 do
    local tool = ball(({ red, green, blue })[k % 3 + 1], math.cos(k), math.sin(k), .6 * math.cos(2 * k), .5)
    deep = k % 2 == 0 and gr.union('deep', deep, tool) or gr.difference('deep', deep, tool)
end
picture('nested', {
    gr.difference('group', block(mirror, .8), group), gr.union('both', group, turned), gr.intersection('again', turned,
        ball(green, 0, 0, 0, .9)), deep,
    gr.instances { of = solid, at = { { -.6, 0, 0 }, { .6, .3, 0 }, { 0, -.5, .8 } }, turn = { 0, 90, 200 }, size = .6 },
    gr.difference('instances', block(white, .9), gr.node { children = { solid, gr.node { children = { solid } }:translate(.9,
        .9, .5) } }),
})

-- meshes and other shapes
local verts, faces = polyhedra.icosahedron()
local crystal = gr.mesh { verts = verts, faces = faces, material = blue }
local round = gr.mesh { verts = verts, faces = faces, material = green, smooth = 180 }
local gear = gr.mesh { file = '../../data/models/gear.stl', material = red, smooth = 25, weld = true }
local low, high = gear:bounds()
gear:translate(-(low[1] + high[1]) / 2, -(low[2] + high[2]) / 2, -(low[3] + high[3]) / 2):scale(1.8 / (high[1] - low[1]),
    1.8 / (high[1] - low[1]), 1.8 / (high[1] - low[1]))
picture('shapes', {
    gr.difference('half', crystal, gr.plane { normal = { -1, .3, 0 }, material = red }), gr.intersection('meshes', round,
        gr.node { children = { crystal } }:translate(.5, .4, 0)),
    gr.union('gear', gear, gr.cylinder { radius = .3, from = { 0, -1, 0 }, to = { 0, 1, 0 }, material = mirror }),
    gr.difference('blob', gr.blob { spheres = { { -.5, 0, 0, 1 }, { .5, .3, 0, 1 } }, material = red },
        gr.prism { outline = { { -.3, -.3 }, { .4, -.2 }, { 0, .5 } }, from = -1, to = 1, material = green }),
    gr.intersection('curves', gr.lathe({ points = { { 0, -1 }, { .9, 0 }, { .4, .5 }, { 0, 1 } }, spline = 'catmull-rom',
        material = blue }), gr.superellipsoid(red, .3, .3):scale(.8, .8, .8)),
    gr.difference('land', gr.height_field { heights = { { 0, .3, 0 }, { .2, .8, .1 }, { 0, .4, 0 } }, floor = -.6,
        material = green }:translate(-.5, 0, -.5):scale(1.8, 1.4, 1.8),
        gr.sweep { points = { { -.9, .2, .5 }, { 0, 0, .3 }, { .9, .4, .6 } }, radii = .25, material = red }),
    gr.difference('tori', gr.torus('a', .8, .3):set_material(red), gr.quadric { xx = 1, yy = -1, zz = 1, constant = -.3,
        min = { -2, -2, -2 }, max = { 2, 2, 2 }, material = blue }),
    gr.intersection('rims', gr.hyperboloid(white), gr.ellipsoid(red, { .9, .6, .7 })), gr.difference('cone',
        gr.paraboloid(mirror), gr.cone { radius = .7, to = { 0, 1.2, 0 }, material = red }),
})

-- materials that depend on the position, holes, glass with other glass in it, walls cut open
local function over(kind, name, fields)
    local all = { material = white, image = textures .. name .. '.png' }
    for key, value in pairs(fields or {}) do all[key] = value end
    return kind(all)
end
local earth = over(gr.image_material, 'earth')
picture('looks', {
    gr.difference('images', gr.sphere { material = earth }, gr.cube { material = over(gr.image_material, 'label'),
        corner = { 0, 0, 0 } }),
    gr.intersection('relief', gr.sphere { material = over(gr.bump_material, 'bricks_height', { tiles = { 6, 3 },
        height = .2 }) }, gr.cube { material = over(gr.bump_material, 'weave_normal',
        { kind = 'normal', tiles = 2 }), corner = { -.8, -.8, -.8 }, size = 1.6 }),
    gr.union('leaves', gr.sphere { material = over(gr.image_material, 'leaves_mask', { channel = 'opacity', tiles = { 4,
        2 } }), radius = .9 }, ball(red, 0, 0, 0, .4)),
    gr.difference('glass', ball(glass, 0, 0, 0), ball(gr.difresnel_material(gr.rr_material({ .2, 0, 0 }, { 1, 1, 1 }, 50, 1, 1,
        1.2)), 0, 0, 0, .6)),
    gr.clipped_by { name = 'open', object = gr.node { children = { gr.sphere { material = gr.material { kd = { .7, .5, .2 },
        two_sided = true } }, ball(blue, 0, 0, 0, .4) } },
        by = gr.union('by', block(white, .8), ball(white, 0, .8, 0, .5)) },
    gr.bounded_by('hint', gr.difference('bounded', block(gr.marble_pnd_material(white, 3, 4, 5, 1, { .2, .1, .1 }), .8),
        ball(gr.wood_pnd_material(red, 2, 8, 1, { .2, .1, 0 }), .7, .7, .7)), ball(white, 0, 0, 0, 3)),
}, { fog = gr.uniform_fog(.02, { .6, .7, .8 }), refract_limit = 8, use_tir = true })
