-- TITLE: Every input of a material with a texture of each kind
-- Covers gr.texture, gr.marble_texture, gr.wood_texture, gr.mix_texture, gr.multiply_texture and constants as kd, ks,
-- shininess, reflect, refract, roughness, emission, opacity, metalness, height of bumps and normal of gr.material and
-- gr.bump_material, on balls, boxes, shapes with their own coordinates, operands of solids, and meshes with colours at
-- vertices. One material is used by shapes with different image mappings.
-- Author: gray project

local textures = '../../textures/'

--- Each kind, as a function of a number of repetitions; all between 0 and 1.
local kinds = {
    { 'image', function(n) return gr.texture { file = textures .. 'checker.png', tiles = n } end },
    { 'marble', function(n) return gr.marble_texture(2 * n, 3, 4 * n, 1) end },
    { 'wood', function(n) return gr.wood_texture(2 * n, 6 * n, 1) end },
    { 'mix', function(n)
        return gr.mix_texture({ .1, .2, .4 }, gr.texture { file = textures .. 'tiles.png', tiles = n },
            gr.marble_texture(2 * n, 3, 3, 0))
    end },
    { 'product', function(n)
        return gr.multiply_texture(gr.texture { file = textures .. 'earth.png', filter = 'bilinear' },
            gr.mix_texture(1, gr.wood_texture(2, 8 * n, 0)))
    end },
    { 'constant', function(n) return gr.multiply_texture(n / 4, { .9, .7, .5 }) end },
}

local kd, ks = { .6, .5, .4 }, { .5, .5, .5 }
--- Each input, as a material that has the texture there.
local inputs = {
    function(t) return gr.material { kd = t(2), ks = ks, shininess = 30 } end,
    function(t) return gr.material { kd = { .1, .1, .1 }, ks = t(2), shininess = 4 } end,
    function(t)
        return gr.material { kd = { .2, .1, .1 }, ks = ks, shininess = gr.mix_texture(60, 2, t(2)) }
    end,
    function(t) return gr.material { kd = { .1, .2, .3 }, ks = { 1, 1, 1 }, shininess = 60, reflect = t(1) } end,
    function(t)
        return gr.material { kd = { .05, .1, .05 }, ks = { .9, 1, .9 }, shininess = 60, refract = t(1), ior = 1.3 }
    end,
    function(t)
        return gr.material { kd = { .1, .1, .1 }, ks = { .9, .8, .6 }, shininess = 40, reflect = .9, glossy_samples = 2,
            roughness = gr.multiply_texture(.5, t(1)) }
    end,
    function(t) return gr.material { kd = { .1, .1, .1 }, ks = ks, shininess = 30, emission = t(2) } end,
    function(t) return gr.material { kd = kd, ks = ks, shininess = 30, opacity = t(2), two_sided = true } end,
    function(t) return gr.material { kd = { .7, .5, .2 }, ks = ks, shininess = 30, metalness = t(2) } end,
    function(t)
        return gr.material { kd = kd, ks = ks, shininess = 30, bump = gr.bump { file = t(1), height = .15 } }
    end,
    function(t)
        return gr.bump_material { material = gr.material { kd = kd, ks = ks, shininess = 30 }, height = .6,
            image = gr.bump { file = t(1), kind = 'normal' } }
    end,
}

local function solid(material)
    return gr.csg_difference(gr.sphere(material), gr.nh_box(material, { 0, 0, 0 }, 2))
end

local function sheet(material)
    return gr.mesh { material = material, verts = { { -.9, -.9, 0 }, { .9, -.9, .3 }, { .9, .9, 0 }, { -.9, .9, .3 } },
        faces = { { 0, 1, 2, 3 } }, uvs = { { 0, 0 }, { 2, 0 }, { 2, 2 }, { 0, 2 } } }
end

local shapes = {
    function(m) return gr.nh_sphere(m, { 0, 0, 0 }, .9) end,
    function(m) return gr.nh_box(m, { -.7, -.7, -.7 }, 1.4):rotate('y', 30):rotate('x', 20) end,
    function(m) return gr.torus { material = m, major = .6, minor = .3 }:rotate('x', 60) end,
    solid,
    sheet,
}

local function picture(name, root)
    gr.render { node = root, file = 'textures-' .. name .. '.png', width = 96, height = 72, eye = { 0, 0, 16 },
        target = { 0, 0, 0 }, fov = 34, ambient = { .25, .25, .25 }, background = 'gradient',
        lights = { gr.light({ -6, 8, 12 }, { .6, .6, .55 }), gr.light({ 8, 2, 9 }, { .3, .3, .4 }) } }
end

-- each input on two shapes that share its material
for k, kind in ipairs(kinds) do
    local root = gr.node 'inputs'
    for i, input in ipairs(inputs) do
        local material = input(kind[2])
        for j = 0, 1 do
            local place, cell = gr.node 'place', 2 * i + j - 2
            place:add_child(shapes[(i + 2 * j + k) % #shapes + 1](material))
            place:translate((cell % 6 - 2.5) * 2.05, (1.5 - cell // 6) * 2.2, 0)
            root:add_child(place)
        end
    end
    picture(kind[1], root)
end

-- textures that a node adds over its material, on every shape, over a material whose kd has the same texture
local root = gr.node 'nodes'
local under = gr.material { kd = gr.texture { file = textures .. 'rug.png' }, ks = ks, shininess = 20,
    bump = gr.bump { file = gr.wood_texture(1, 3, 1), height = .1 } }
for i, shape in ipairs(shapes) do
    for row = 1, 3 do
        local place, node = gr.node 'place', shape(under)
        if i ~= 4 and row > 1 then node:set_texture(textures .. 'panel.png') end
        if i ~= 4 and row > 2 then node:set_bump(textures .. 'bricks_height.png') end
        place:add_child(node)
        place:translate((i - 3) * 2.3, (2 - row) * 2.6, 0)
        root:add_child(place)
    end
end
picture('nodes', root)
