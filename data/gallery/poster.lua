-- TITLE: A poster in low sun
-- OPTIONS: --size 300x400 --spp 9
-- LARGE: --spp 64
-- Letters as a relief on paper, seen straight on; the only lamp is a sun two hands above the wall, so every letter draws its
-- own long shadow, and red letters tint the paper beside them. All lines have the same width.
local text = require 'text'
local scene = gr.node 'poster'
local function paper(colour, strength)             -- fibres, a little unevenness, specks
    return gr.openpbr_material{specular_weight = .25, specular_roughness = .65,
        base_color = function(p)
            local fibre = gr.noise(p.x * 26, p.y * 5, 1) + gr.noise(p.x * 6, p.y * 30, 2)
            local speck = gr.smoothstep(.80, .86, gr.hash(p * 38 // 1)) * gr.smoothstep(.3, .2, gr.length(p * 38 % 1 - gr.vec(.5, .5, .5)))
            return colour * (1 + .035 * fibre - .05 * gr.turbulence(p * .8, 3)) * (1 - .16 * speck)
        end,
        geometry_normal = gr.bump(function(p) return strength * (gr.noise(p.x * 22, p.y * 22, 3) + .5 * gr.noise(p * 55)) end, .004)}
end
local sheet = paper(gr.vec(.80, .75, .64), 1)
local ink = gr.openpbr_material{base_color = {.020, .035, .075}, specular_roughness = function(p) return .34 + .12 * gr.noise(p * 3) end}
local red = gr.openpbr_material{base_color = {.62, .045, .020}, specular_roughness = function(p) return .32 + .12 * gr.noise(p * 3) end}
local ochre = gr.openpbr_material{base_color = {.66, .36, .045}, specular_roughness = function(p) return .30 + .12 * gr.noise(p * 3) end}
local gold = gr.metal_material{metal = 'gold', roughness = function(p) return .22 + .10 * gr.turbulence(p * 4, 3) end}
scene:add_child(gr.plane{material = sheet, normal = {0, 0, 1}})

-- a line of text, scaled to the width of the column; y is its lower edge, the result its height
local left, width = -3.3, 6.6
local function line(word, y, depth, material, weight)
    local verts, normals, faces, corners = text.mesh(word, {size = 4, weight = weight, depth = 1, bevel = .07, steps = 4, tolerance = .0015})
    local low, high = {math.huge, math.huge}, {-math.huge, -math.huge}
    for _, v in ipairs(verts) do
        for k = 1, 2 do low[k], high[k] = math.min(low[k], v[k]), math.max(high[k], v[k]) end
    end
    local scale = width / (high[1] - low[1])
    scene:add_child(gr.vn_mesh(material, verts, normals, faces, corners):translate(-low[1], -low[2], 0):scale(scale, scale, depth):translate(left, y, 0))
    return scale * (high[2] - low[2])
end
local function rule(y, height, depth)
    scene:add_child(gr.box{material = ink, min = {left, y, 0}, max = {left + width, y + height, depth}, edge = .03})
end
rule(3.92, .10, .25)
local y = -4.35
rule(y, .10, .25)
y = y + .42
y = y + line('NUMBERS', y, .42, ink, 1.5) + .40
y = y + line('is a line of', y, .26, ochre, 1.15) + .42
y = y + line('LIGHT', y, .70, red, 1.6)
scene:add_child(gr.sphere{material = gold, centre = {left + width - .52, 2.85, .52}, radius = .52})
scene:add_child(gr.cone{material = ink, from = {left + .48, 2.85, 1.1}, to = {left + .48, 2.85, 0}, radius = .5})
scene:add_child(gr.box{material = red, min = {left + 2.05, 2.4, 0}, max = {left + 2.95, 3.3, .9}, edge = .04})
scene:add_child(gr.torus(ink, .40, .13):rotate('x', 90):translate(left + 4.2, 2.85, .14))

gr.render{node = scene, file = 'poster.png', width = 1200, height = 1600, eye = {0, -.16, 20}, view = {0, 0, -1}, projection = 'orthographic', view_height = 9.9,
    integrator = 'path', denoise = true, tone = 'filmic', exposure = .45, background = {.2, .3, .5},
    lights = {gr.spherical_light{position = {-25, 13, 13}, radius = .55, emission = {2300, 1480, 720}}, gr.sky_light{sky = {.085, .12, .20}}}}
