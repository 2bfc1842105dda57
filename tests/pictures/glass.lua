-- TITLE: Glass and nested media
-- Covers refraction with and without gr.difresnel_material, use_tir, absorption, roughness from polished to 1 with
-- glossy_samples, water in a glass with air in it, solids that overlap, glass seen from inside, coloured shadows, and
-- refract and reflect limits.
-- Author: gray project

local function glass(fields)
    fields.kd, fields.ks, fields.shininess = fields.kd or { 0, 0, 0 }, fields.ks or { .95, .97, .96 }, 200
    fields.reflect, fields.refract, fields.ior = fields.reflect or 1, fields.refract or 1, fields.ior or 1.5
    return gr.rr_material(fields)
end
local function fresnel(fields) return gr.difresnel_material(glass(fields or {})) end

local function stage(things)
    local root = gr.node 'stage'
    root:add_child(gr.plane { normal = { 0, 1, 0 }, material = gr.image_material { tiles = .5,
        image = '../../textures/tiles.png',
        material = gr.material({ .8, .8, .8 }, { 0, 0, 0 }, 1) } })
    root:add_child(gr.rectangle { corner = { -6, 0, -4 }, along = { 12, 0, 0 }, up = { 0, 6, 0 },
        material = gr.image_material(gr.material { kd = { .8, .8, .8 } }, '../../textures/rug.png') })
    for _, thing in ipairs(things) do root:add_child(thing) end
    return root
end

local function picture(name, things, fields)
    fields = fields or {}
    fields.node, fields.file, fields.width, fields.height = stage(things), 'glass-' .. name .. '.png', 96, 72
    fields.eye, fields.target, fields.fov = fields.eye or { .4, 2.6, 8 }, fields.target or { 0, 1.1, 0 }, fields.fov or 36
    fields.ambient, fields.background = { .25, .25, .28 }, { .5, .6, .8 }
    fields.lights, fields.lamps = fields.lamps or { gr.light({ -4, 7, 5 }, { .6, .6, .6 }), gr.area_light({ 3, 6, 2 }, { 1, 0,
        0 }, { 0, 0, 1 }, { .3, .3, .3 }, { 1, 0, 0 }) }, nil
    gr.render(fields)
end

local function row(materials)
    local things = {}
    for k, material in ipairs(materials) do
        local place = (k - (#materials + 1) / 2) * 1.3
        things[k] = k % 2 == 1 and gr.sphere { centre = { place, .75, 0 }, radius = .7, material = material } or
            gr.box { min = { place - .5, .1, -.5 }, max = { place + .5, 1.4, .5 }, material = material }
    end
    return things
end

local polished = row {
    glass { reflect = .2, refract = .7 }, glass { reflect = .1, refract = .8, ior = 1.1, kd = { .1, .1, .2 } }, fresnel {},
    fresnel { ior = 2.4, ks = { .9, .7, .9 } }, fresnel { ior = 1 },
}
picture('polished', polished)
picture('beyond', polished, { use_tir = true, refract_limit = 9, reflect_limit = 5, eye = { 2.5, 1.2, 6 } })

picture('rough', row {
    fresnel { roughness = .03, glossy_samples = 2 }, fresnel { roughness = .2, glossy_samples = 3 }, fresnel { roughness = .5,
        glossy_samples = 2 },
    glass { reflect = .1, refract = .9, roughness = .3, glossy_samples = 2 }, fresnel { roughness = 1, glossy_samples = 2,
        absorption = { .2, 1, 1 } },
}, { refract_limit = 3 })

-- a glass of water with a bubble and a marble in it; an overlap has the medium that was entered last
local water = fresnel { ior = 1.33, absorption = { .5, .15, .05 } }
local wall = fresnel { ior = 1.5, absorption = { .05, .02, .05 } }
local function tumbler(x)
    return {
        gr.difference('wall', gr.cylinder { from = { x, .05, 0 }, to = { x, 2, 0 }, radius = .8, material = wall },
            gr.cylinder { from = { x, .2, 0 }, to = { x, 2.1, 0 }, radius = .7, material = wall }),
        gr.cylinder { from = { x, .15, 0 }, to = { x, 1.5, 0 }, radius = .75, material = water },
        gr.sphere { centre = { x - .2, 1, .1 }, radius = .3, material = fresnel { ior = 1 } },
        gr.sphere { centre = { x + .3, .5, .2 }, radius = .25, material = gr.material({ .8, .2, .1 }, { .5, .5, .5 }, 40) },
    }
end
local things = tumbler(-1.1)
things[#things + 1] = gr.sphere { centre = { 1, .9, 0 }, radius = .85, material = fresnel { ior = 1.5, absorption = { .1, .6,
    .6 } } }
things[#things + 1] = gr.sphere { centre = { 1.6, .9, .3 }, radius = .7, material = fresnel { ior = 1.7, absorption = { .6, .6,
    .1 } } }
things[#things + 1] = gr.sphere { centre = { 1, .9, 0 }, radius = .6, material = fresnel { ior = 1 } }
picture('nested', things, { use_tir = true, refract_limit = 12, reflect_limit = 2 })

-- from inside of water with a bubble in it, and glass that has a colour of its own
local sea = gr.box { min = { -5, -1, -3.8 }, max = { 5, 1.6, 12 }, material = fresnel { ior = 1.33, absorption = { .06, .02,
    .01 } } }
picture('inside', { sea, gr.sphere { centre = { -.7, .8, 2 }, radius = .5, material = fresnel { ior = 1 } },
    gr.sphere { centre = { .8, 1.4, 2 }, radius = .6, material = fresnel { ior = 1.5 } },
    gr.torus { major = .5, minor = .15, material = glass { kd = { .3, .1, 0 }, reflect = .2, refract = .5, absorption = { 0, 1,
        2 },
        emission = { .1, 0, .1 } } }:rotate('x', 70):translate(.2, .5, 3) }, { eye = { 0, .9, 6 }, use_tir = true,
            lamps = { gr.light({ 1, 1.3, 6 }, { .8, .8, .8 }), gr.light({ -2, 5, 4 }, { .7, .7, .7 }) } })

-- rough through polished through marble; thin sheets that refract; two-sided glass
local frosted = fresnel { roughness = .15, glossy_samples = 2, absorption = { 1, .3, .1 } }
picture('mixed', {
    gr.box { min = { -2.4, .1, .8 }, max = { -.4, 1.8, 1 }, material = frosted },
    gr.sphere { centre = { -1.2, .8, -.4 }, radius = .8, material = gr.marble_pnd_material(fresnel { kd = { .1, .1, .1 } }, 2,
        4, 4, 1, { .2, .5, .2 }) },
    gr.rectangle { corner = { .3, .1, 1 }, along = { 1.4, 0, .3 }, up = { 0, 1.6, 0 }, material = glass { reflect = .2,
        refract = .8, ior = 1.5, two_sided = true } },
    gr.sphere { centre = { 1.2, .8, -.6 }, radius = .8, material = gr.wood_pnd_material(glass { kd = { .2, .2, .2 },
        reflect = .1, refract = .6, roughness = .1,
        glossy_samples = 2 }, 2, 8, 0, { .4, .2, .1 }) },
    gr.disc { centre = { 2.4, 1, .5 }, normal = { -.5, 0, 1 }, radius = .8, inner = .3, material = frosted },
}, { cutoff = 0, refract_limit = 3 })
