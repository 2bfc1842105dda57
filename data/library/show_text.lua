-- TITLE: Library: solid letters
-- Text as bevelled meshes and as exact prisms in CSG: a sign with letters cut into it. From a font file if FreeType is
-- installed, otherwise from the equal letters of the library.
-- Author: gray project

local studio = require 'studio'
local text = require 'text'

local scene = gr.node 'letters'
local font = text.has_fonts() and '../fonts/gray-round.ttf' or nil
if not font then print 'this build has no FreeType: the letters are those of the library' end

local function at(x, y, z, turn, node) studio.place(scene, node, x, y, z, turn) end

-- Large letters with round edges, each in its colour.
local pen = 0.9 * 0.7 / 12 * 2.9
local colours = { 'b03a2e', 'd68a1f', '4b8b3b', '2c6e9b' }
local x = -3.7
for k, letter in ipairs { 'g', 'r', 'a', 'y' } do
    local material = studio.glaze(studio.colour.hex(colours[k]))
    local mesh = { text.mesh(letter, { font = font, size = 2.9, depth = 0.75, bevel = 0.07, steps = 5, back = true, tolerance = 0.004 }) }
    at(x, 1.15 + pen + 0.62, -1.6, 0, gr.vn_mesh(material, table.unpack(mesh)))
    x = x + text.letters(letter, { font = font, size = 2.9 }).width + 0.16
end

scene:add_child(gr.box { min = { -4.3, 0, -2.1 }, max = { 4.3, 1.15, -0.3 }, material = studio.matt { 0.75, 0.74, 0.72 } })

-- A slab with words cut into it, the cut in gold.
local slab = gr.box { min = { -2.6, 0, -0.16 }, max = { 2.6, 1.5, 0.16 }, material = studio.matt { 0.035, 0.04, 0.06 } }
local words = { text.mesh('light, seen through\na small window', { font = font, size = 0.46, depth = 0.3, align = 'centre' }) }
local lean = gr.node 'lean'
lean:rotate('x', -14)
lean:add_child(gr.difference('sign', slab, gr.vn_mesh(studio.gold, table.unpack(require 'meshes'.translate(words, 0, 0.86, 0.1)))))
at(-1.5, 0.04, 2.2, 8, lean)

-- Exact prisms: a small word of glass.
local glass = gr.openpbr_material { transmission_weight = 1, transmission_color = { 0.80, 0.95, 0.92 }, transmission_depth = 0.4, specular_roughness = 0 }
at(2.3, 0.07, 2.2, -14, text.node('0123', { font = font, size = 1.0, depth = 0.35, material = glass }))

studio.render {
    node = scene, file = 'show_text.png', eye = { 0, 4.6, 16 }, target = { 0, 1.75, 0 }, fov = 23, floor = { 0.30, 0.27, 0.23 },
    key = { -9, 10, 4 }, lamp = 2, light = { 2.0, 1.5, 0.95 }, sky = { 0.18, 0.22, 0.32 },
}
