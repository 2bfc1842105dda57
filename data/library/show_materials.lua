-- TITLE: Library: forty materials by name
-- Forty samples in a studio: woods, stones, metals, paints, ceramics, fabrics, liquids and glasses of the library. With
-- -D each=true a picture of each, as in docs/library.md; -D each=oak one of these.
-- Author: gray project

local materials = require 'materials'

--- A ball with a groove on a foot, 2 units large.
local function sample(name)
    local m = materials.named(name)
    local groove = gr.torus { major = 0.98, minor = 0.07, material = m }:translate(0, 0.32, 0)
    local below = gr.box { min = { -2, -2, -2 }, max = { 2, -0.93, 2 }, material = m }
    local foot = gr.cylinder { from = { 0, -1.08, 0 }, to = { 0, -0.9, 0 }, radius = 0.62, material = m }
    return gr.node { name = name, children = { gr.difference(gr.sphere { material = m }, groove, below), foot } }
end

local function show(node, file, width, height, spp, view)
    gr.render(gr.studio {
        node = node, file = file, width = width, height = height, view = view, integrator = 'path', spp = spp, denoise = true, tone = 'filmic' })
end

local all = gr.node 'materials'
for k, name in ipairs(materials.names()) do
    local node, family = sample(name), materials.families[name]
    if each == true or each == name then
        local is_clear = family == 'glass' or family == 'liquid'
        show(node, 'materials/' .. name:gsub(' ', '_') .. '.png', 240, 240, is_clear and 32 or 12, { -0.25, -0.3, -1 })
    elseif not each then
        local row, column = (k - 1) // 8, (k - 1) % 8
        all:add_child(node:translate(2.5 * (column - 3.5), 1.08, 2.9 * row))
    end
end
if not each then show(all, 'show_materials.png', 960, 540, 8, { 0, -0.75, -1 }) end
