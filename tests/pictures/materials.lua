-- TITLE: Opaque materials and their decorators
-- Covers gr.material and gr.rr_material (Phong and Blinn highlights at many exponents, lit, two_sided, emission, mirrors,
-- rough metal at several roughnesses and glossy_samples), gr.marble_pnd_material, gr.wood_pnd_material,
-- gr.td_cube_material, gr.td_sphere_material, gr.image_material (all channels) and gr.bump_material, composed in both
-- orders, over materials that reflect and that refract.
-- Author: gray project

local textures = '../../textures/'

--- Places objects in rows in front of a floor and returns the root.
local function shelf(things, columns, spacing)
    local root = gr.node 'shelf'
    for k, thing in ipairs(things) do
        local place = gr.node 'place'
        place:add_child(thing)
        local column, row = (k - 1) % columns, (k - 1) // columns
        place:translate((column - (columns - 1) / 2) * (spacing or 2.2), 1 + row * 2.2, -row * .8)
        root:add_child(place)
    end
    root:add_child(gr.plane { normal = { 0, 1, 0 }, material = gr.image_material { tiles = .25,
        image = textures .. 'checker.png',
        material = gr.material { kd = { .8, .8, .8 } } } })
    return root
end

local function picture(name, root, fields)
    fields = fields or {}
    fields.node, fields.file, fields.width, fields.height = root, 'materials-' .. name .. '.png', 96, 72
    fields.eye, fields.target, fields.fov = { 0, 3.2, 11 }, { 0, 2.9, 0 }, fields.fov or 46
    fields.ambient, fields.background = { .2, .2, .22 }, { .3, .4, .6 }
    fields.lights = {
        gr.light({ -6, 8, 8 }, { .6, .6, .55 }), gr.light({ 5, 4, 9 }, { .3, .3, .4 }),
        gr.area_light({ 3, 7, -2 }, { 2, 0, 0 }, { 0, 0, 2 }, { .3, .25, .2 }, { 1, 0, 0 }),
    }
    gr.render(fields)
end

local function ball(material) return gr.sphere(material) end

-- highlights; an open shape shows its back
local red, gray = { .6, .15, .1 }, { .7, .7, .7 }
local function bowl(material)
    return gr.paraboloid { material = material, open = true, height = 1.4 }:rotate('x', 60)
end
local highlights = {
    ball(gr.material(red, gray, 0)), ball(gr.material(red, gray, 3)), ball(gr.material(red, gray, 40)), ball(gr.material(red,
        gray, 4000)),
    ball(gr.material { kd = red, ks = gray, shininess = 40, highlight = 'blinn' }),
    ball(gr.material { kd = red, ks = gray, shininess = 3, highlight = 'phong' }),
    ball(gr.material { kd = red, ks = gray, shininess = 40, emission = { 0, .2, .4 } }),
    ball(gr.material { kd = red, ks = gray, lit = false }),
    bowl(gr.material { kd = red, ks = gray, shininess = 20 }), bowl(gr.material { kd = red, ks = gray, shininess = 20,
        two_sided = true }),
    bowl(gr.material { kd = { 0, 0, 0 }, ks = { 1, 1, 1 }, shininess = 10, two_sided = true, highlight = 'blinn' }),
    bowl(gr.material { kd = red, emission = { .1, .3, .1 }, lit = false, two_sided = true }),
}
picture('phong', shelf(highlights, 4))
highlights[1] = nil
for k = 2, 4 do highlights[k - 1] = ball(gr.material(red, gray, ({ 3, 40, 4000 })[k - 1])) end
highlights[4] = bowl(gr.material { kd = red, ks = gray, shininess = 30, two_sided = true })
picture('blinn', shelf({ table.unpack(highlights, 1, 4) }, 2), { specular = 'blinn' })

-- mirrors and rough metals that reflect each other
local gold = { .9, .7, .35 }
local function metal(fields)
    fields.kd, fields.ks, fields.shininess = fields.kd or { .1, .07, .03 }, fields.ks or gold, fields.shininess or 60
    return ball(gr.rr_material(fields))
end
picture('metals', shelf({
    metal { reflect = 1 }, metal { reflect = .3, kd = { .2, .3, .5 } }, metal { reflect = .9, roughness = .02 },
    metal { reflect = .9, roughness = .2, glossy_samples = 2 }, metal { reflect = .9, roughness = .5, glossy_samples = 1 },
    metal { reflect = .9, roughness = 1, glossy_samples = 6 },
    metal { reflect = 1, roughness = .3, ks = { .3, .9, .5 }, highlight = 'blinn', glossy_samples = 3 },
    ball(gr.material { kd = { .05, .05, .2 }, ks = gray, reflect = .5, emission = { .1, 0, 0 } }),
    ball(gr.difresnel_material(gr.rr_material { kd = { .5, .1, .1 }, ks = { .9, .9, .9 }, reflect = 1, ior = 1.6,
        shininess = 200, roughness = .1 })),
}, 3, 2.4), { reflect_limit = 4 })

-- decorators in both orders
local base = gr.rr_material({ .8, .75, .7 }, { .5, .5, .5 }, 60, .2, 0, 1)
local clear = gr.rr_material({ .1, .12, .1 }, { .9, .9, .9 }, 60, .1, .7, 1.2)
local function marble(below, interp) return gr.marble_pnd_material(below, 2, 6, 5, interp or 1, { .1, .15, .3 }) end
local function wood(below, interp) return gr.wood_pnd_material(below, 1.5, 9, interp or 1, { .3, .12, .04 }) end
local function image(below) return gr.image_material { material = below, image = textures .. 'ball.png' } end
local function earth(below) return gr.td_sphere_material { material = below, png = textures .. 'earth.png' } end
local function bump(below) return gr.bump_material { material = below, image = textures .. 'bricks_height.png', tiles = { 6,
    3 }, height = .1 } end
picture('decorators', shelf({
    ball(marble(base)), ball(wood(base)), ball(marble(wood(base, 0), 0)), ball(wood(marble(base, 0), 0)),
    ball(marble(image(base))), ball(image(marble(base))), ball(bump(wood(image(base)))), ball(wood(image(bump(base)))),
    ball(marble(clear)), ball(earth(marble(clear))), ball(wood(earth(bump(clear)))),
        ball(gr.difresneld_material(marble(bump(clear)))),
}, 4), { specular = 'phong' })

-- images by the unit cube and sphere, and in every channel, in both orders
local function crate(material) return gr.cube(material):translate(-.5, -.5, -.5):scale(1.5, 1.5, 1.5):rotate('y',
    35):rotate('x', 20) end
local function channel(below, name, file, tiles)
    return gr.image_material { material = below, image = textures .. file .. '.png', channel = name, tiles = tiles or 2 }
end
local dull = gr.material { kd = { .5, .5, .6 }, ks = { .8, .8, .8 }, shininess = 12, two_sided = true }
local holes = channel(dull, 'opacity', 'leaves_mask')
picture('channels', shelf({
    crate(gr.td_cube_material(base, textures .. 'label.png')),
    crate(gr.td_cube_material { material = marble(base), png = textures .. 'tiles.png', filter = 'nearest', flip_u = true }),
    ball(gr.td_sphere_material { material = base, png = textures .. 'earth.png', filter = 'bilinear', flip_u = true }),
    ball(channel(channel(dull, 'ks', 'checker'), 'emission', 'star')),
    crate(channel(dull, 'opacity', 'star')), ball(image(holes)), ball(channel(marble(dull), 'opacity', 'leaves_mask')),
    ball(channel(channel(dull, 'kd', 'rug'), 'ks', 'ball')),
    ball(channel(wood(base), 'opacity', 'checker')), crate(bump(channel(clear, 'opacity', 'leaves_mask'))),
    ball(channel(gr.difresnel_material(clear), 'opacity', 'checker', 3)), crate(channel(bump(dull), 'emission', 'earth', 1)),
}, 4))

-- decorated rough metal and decorated lamps; a cutoff and no reflections at all
picture('limits', shelf({
    ball(marble(gr.rr_material { kd = { .3, .3, .3 }, ks = gold, reflect = .8, roughness = .3, glossy_samples = 2 })),
    ball(bump(gr.rr_material { kd = { .1, .1, .1 }, ks = gold, reflect = 1, shininess = 50 })),
    ball(wood(gr.material { kd = { .3, .3, .3 }, emission = { .2, .2, .5 } })), ball(channel(clear, 'kd', 'tiles')),
}, 2), { reflect_limit = 1, refract_limit = 1, cutoff = .2, use_tir = true })
