-- TITLE: The dining room, path traced
-- OPTIONS: --spp 56
-- The room of 14demo.lua with materials that are made for paths: evening light comes in through the window, the bulb
-- of the lamp glows, and everything else is lit by the walls, the table and the floor.
local here = debug.getinfo(1, 'S').source:match('^@(.*/)') or './'
package.path = here .. '../?.lua;' .. package.path
local room = require 'room'
local place = room.place
room.textures = '' -- those that come with gray

local function materials(m)
    local function glossy(r, g, b, roughness)
        return gr.openpbr_material { base_color = { r, g, b }, specular_roughness = roughness }
    end
    m.glow = gr.material { kd = { 0, 0, 0 }, emission = { 36, 28, 17 } }
    m.gold = gr.metal_material { metal = 'gold', roughness = .35 }
    m.brass = gr.metal_material { metal = 'brass', roughness = .25 }
    m.mirror = gr.metal_material { metal = 'silver', roughness = 0 }
    m.white = glossy(.76, .73, .66, .4)
    m.china = glossy(.75, .75, .72, .15)
    m.glaze = glossy(.08, .24, .28, .15)
    m.tea = glossy(.12, .04, .01, .05)
    m.carved = glossy(.38, .19, .09, .35)
    m.marble = gr.openpbr_material { specular_roughness = .12,
        base_color = gr.mix_texture({ .76, .73, .68 }, { .42, .36, .33 }, gr.marble_texture(1.5, 4.2, 9, 1)) }
    m.vase = gr.openpbr_material { specular_roughness = .15,
        base_color = gr.mix_texture({ .1, .16, .42 }, { .72, .74, .76 }, gr.marble_texture(5, 3.5, 26, 1)) }
end

local eye = { -1.22, 1.42, 2.55 }
local root = room.build { eye = eye, ambient = { 1, 1, 1 }, materials = materials }

-- Paths find the sky behind glass only by chance. So the panes emit light of the colour of the sky.
local w = room.window
local panes = gr.area_light { corner = place { w.x0 + .05, w.y0 + .05, room.back - .08 },
    v1 = place { w.x1 - w.x0 - .1, 0, 0 }, v2 = place { 0, w.y1 - w.y0 - .1, 0 },
    colour = { 1, 1, 1 }, emission = { 4.2, 3.4, 2.8 }, visible = false }

gr.render {
    node = root, file = 'dining.png', width = 400, height = 300, integrator = 'path', denoise = true,
    eye = place(eye), target = place { eye[1] + .49, eye[2] - .155, eye[3] - 1 }, fov = 43,
    background = gr.sky_cross { image = 'sky_dusk.png' }, lights = { panes },
    tone = 'filmic', exposure = 2, filter = 'gaussian',
}
