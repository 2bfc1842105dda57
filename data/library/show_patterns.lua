-- TITLE: Library: patterns, each a line of Lua
-- A wall of balls and tiles with the patterns of the library, which are recorded Lua functions; docs/library.md lists the
-- functions.
-- Author: gray project

local studio = require 'studio'
local patterns, text = require 'patterns', require 'text'
local map, mix, vec = patterns.map, gr.mix, gr.vec

local clay, lime, slate, cream = vec(0.62, 0.20, 0.12), vec(0.75, 0.72, 0.66), vec(0.16, 0.20, 0.26), vec(0.90, 0.84, 0.70)
local list = {
    { 'checker', function(p) return mix(slate, cream, patterns.checker(p * 4)) end },
    { 'gradient', function(p) return mix(slate, vec(0.95, 0.55, 0.15), patterns.gradient(p * 3, { 0.6, 0.8, 0 })) end },
    { 'bricks', function(p)
        local inside, id = patterns.bricks(p * 2)
        return mix(lime, clay * (0.7 + 0.6 * id), inside)
    end },
    { 'hexagons', function(p)
        local kind, inside = patterns.hexagons(vec(p.x, p.z, p.y) * 3)
        return gr.where(inside - 0.03, gr.lookup({ clay, cream, slate }, kind + 1), 0.05)
    end },
    { 'spots', function(p) return mix(cream, vec(0.75, 0.08, 0.10), patterns.spots(p * 4, 0.4)) end },
    { 'clouds', function(p) return map('sky', patterns.clouds(p * 2)) end },
    { 'turbulence', function(p) return mix(vec(0.95, 0.75, 0.2), vec(0.6, 0.05, 0.02), patterns.turbulence(p * 2)) end },
    { 'cells', function(p)
        local id, inside = patterns.cells(p * 4)
        return mix(0.05, vec(0.3 + 0.4 * id, 0.5, 0.3), gr.smoothstep(0.02, 0.12, inside))
    end },
    { 'marble', function(p) return map('marble', patterns.marble(p * 1.5)) end },
    { 'wood', function(p) return map('pine', patterns.wood(p * 1.5 + vec(1, 0.2, 0))) end },
    { 'agate', function(p) return map('agate', patterns.agate(p * 1.2)) end },
    { 'granite', function(p) return map('granite', patterns.granite(p * 2)) end },
    { 'leopard', function(p) return map('leopard', patterns.leopard(p * 3)) end },
    { 'rings', function(p) return mix(cream, vec(0.1, 0.35, 0.4), patterns.rings(vec(p.x, p.z, p.y) * 3)) end },
    { 'map', function(p) return map({ { 0, { 0.9, 0.2, 0.1 } }, { 0.5, { 0.95, 0.9, 0.7 } }, { 0.5, { 0.1, 0.3, 0.6 } }, { 1, { 0, 0, 0.1 } } }, p.y / 1.5 + 0.5) end },
}

local scene = gr.node 'patterns'
local ink = gr.material { kd = { 0, 0, 0 }, emission = { 0.75, 0.74, 0.70 } } -- shines, so no shadow covers a word
for k, entry in ipairs(list) do
    local name, f = entry[1], entry[2]
    local material = gr.openpbr_material { base_color = f, specular_roughness = 0.35 }
    local x, y = ((k - 1) % 5 - 2) * 2.3, (2 - (k - 1) // 5) * 2.15
    local item = gr.node { name = name }
    item:add_child(gr.box { min = { -0.75, -0.75, -0.3 }, max = { 0.75, 0.75, -0.05 }, material = material })
    item:add_child(gr.sphere { centre = { 0.55, -0.42, 0.25 }, radius = 0.34, material = material })
    item:translate(x, y + 1.35, 0)
    scene:add_child(item)
    scene:add_child(text.node(name, { size = 0.26, depth = 0.05, align = 'centre', material = ink }):translate(x, y + 0.2, 0))
end

studio.render {
    node = scene, file = 'show_patterns.png', size = { 960, 540 }, spp = 3, eye = { 0, 3.4, 17 }, target = { 0, 3.22, 0 }, fov = 24, key = { -9, 9, 16 }, lamp = 2,
    light = { 0.95, 0.90, 0.82 }, floor = { 0.24, 0.24, 0.25 },
}
