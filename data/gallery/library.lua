-- TITLE: A library at night
-- OPTIONS: --size 400x250 --spp 12
-- LARGE: --spp 96
-- Rain on a window, and behind it the light of two lamps on old books. Drops are caps of water that show the room upside down;
-- some have run down and left their track. The lens is focused on the glass.
local random, patterns = require 'random', require 'patterns'
local scene = gr.node 'library'
local dice = random.new(21)

-- drops on the pane at z = 0: large ones keep their distance, small ones fill the space; tracks are clear
local water = gr.openpbr_material{transmission_weight = 1, specular_roughness = 0, specular_ior = 1.33}
local drops, tracks = {}, {}
for _ = 1, 13 do tracks[#tracks + 1] = {dice:range(-1.5, 1.5), dice:range(-.5, 1.0), dice:range(.016, .028), dice:range(0, 9)} end
local function track_x(t, y) return t[1] + .016 * math.sin(9 * y + t[4]) + .010 * math.sin(23 * y + 2 * t[4]) end
local function drop(x, y, r, tall)
    for _, d in ipairs(drops) do if (d[1] - x) ^ 2 + (d[2] - y) ^ 2 < (d[3] + r) ^ 2 * 1.08 then return end end
    drops[#drops + 1] = {x, y, r}
    local cap = gr.sphere{material = water, radius = 1, centre = {0, 0, -.28}}
    scene:add_child(gr.intersection(cap, gr.box(water, {-2, -2, 0}, {2, 2, 2})):scale(r, r * tall, r * .62):rotate('z', dice:range(-12, 12)):translate(x, y, .0008))
end
for _, t in ipairs(tracks) do
    drop(track_x(t, t[2]), t[2], t[3] * 1.25, 1.35)
    for _ = 1, 34 do local y = t[2] + dice:range(.03, 1.5) drop(track_x(t, y), y, dice:range(.003, .009), dice:range(1, 1.3)) end
end
for _ = 1, 5200 do
    local x, y = dice:range(-1.55, 1.55), dice:range(-.95, .95)
    local r = .0045 + .026 * dice:range(0, 1) ^ 4.5
    local free = true
    for _, t in ipairs(tracks) do free = free and not (y > t[2] and math.abs(x - track_x(t, y)) < t[3] * .9 + r) end
    if free then drop(x, y, r, dice:range(.95, 1.2)) end
end
scene:add_child(gr.rectangle{material = gr.openpbr_material{transmission_weight = 1, specular_roughness = 0, specular_ior = 1.5, geometry_thin_walled = true}, corner = {-3, -2, 0}, along = {6, 0, 0}, up = {0, 4, 0}})
local paint = gr.openpbr_material{base_color = function(p) return gr.vec(.16, .17, .16) * (1 - .3 * gr.turbulence(p * 3, 4)) end, specular_roughness = .45, coat_weight = .6, coat_roughness = .1}
for _, x in ipairs{-1.06, 1.06} do scene:add_child(gr.box{material = paint, min = {x - .035, -2, -.03}, max = {x + .035, 2, .045}, edge = .012}) end
scene:add_child(gr.box{material = paint, min = {-3, .56, -.03}, max = {3, .62, .04}, edge = .012})
scene:add_child(gr.box{material = paint, min = {-3, -1.3, -.05}, max = {3, -.98, .10}, edge = .02})

-- the room: 7 wide, 3.4 high, 6 deep; shelves on three walls
local wood = gr.openpbr_material{specular_roughness = .4, base_color = function(p)
    return gr.mix(gr.vec(.17, .075, .032), gr.vec(.07, .028, .012), patterns.wood(gr.vec(p.x * .6, p.z * .6, p.y * .15))) end}
local plaster = gr.openpbr_material{base_color = {.42, .34, .25}, specular_roughness = .8}
local floor_y, ceiling, back = -1.55, 1.95, -6.4
scene:add_child(gr.box{material = wood, min = {-3.8, floor_y - .1, back}, max = {3.8, floor_y, -.2}})
scene:add_child(gr.box{material = plaster, min = {-3.8, ceiling, back}, max = {3.8, ceiling + .1, -.05}})
scene:add_child(gr.box{material = plaster, min = {-3.8, floor_y, back - .1}, max = {3.8, ceiling, back}})
for s = -1, 1, 2 do scene:add_child(gr.box{material = plaster, min = {s * 3.75 - .05, floor_y, back}, max = {s * 3.75 + .05, ceiling, 0}}) end
local bindings = {}
for i, c in ipairs{{.28, .045, .03}, {.035, .085, .06}, {.05, .06, .13}, {.30, .17, .06}, {.16, .06, .035}, {.42, .33, .20}, {.05, .04, .035}, {.22, .02, .05}} do
    bindings[i] = gr.openpbr_material{specular_roughness = .45, base_color = function(p)      -- bands of gold across the spine
        local y = p.y * 24 % 1
        local band = gr.smoothstep(.46, .48, y) * gr.smoothstep(.56, .54, y) * gr.step(.45, gr.hash(gr.vec(p.x * 12 // 1, p.y * 3 // 1, p.z * 12 // 1)))
        return gr.mix(gr.vec(c[1], c[2], c[3]) * (.8 + .4 * gr.noise(p * 8)), gr.vec(.55, .38, .10), .8 * band)
    end}
end
local function shelves(length, height)             -- along x from 0, books look to +z
    local node, rows = gr.node 'shelves', 7
    local step = height / rows
    for k = 0, rows do node:add_child(gr.box{material = wood, min = {0, k * step - .018, -.36}, max = {length, k * step + .018, .03}}) end
    for k = 0, math.floor(length / 1.05) do node:add_child(gr.box{material = wood, min = {k * 1.05 - .02, 0, -.36}, max = {k * 1.05 + .02, height, .035}}) end
    for k = 0, rows - 1 do
        local x = .04
        while x < length - .08 do
            local w, h = dice:range(.022, .062), step * dice:range(.62, .88)
            if dice:chance(.04) then x = x + dice:range(.05, .25) end
            if x % 1.05 > .03 and x % 1.05 + w < 1.02 and x + w < length then
                local book = gr.box{material = bindings[math.ceil(dice:range(0, 8))], min = {0, 0, -.30}, max = {w, h, dice:range(-.07, -.01)}, edge = .004}
                node:add_child(gr.node{children = {book}}:rotate('z', dice:chance(.08) and -9 or 0):translate(x, k * step + .018, 0))
            end
            x = x + w + .002
        end
    end
    return node
end
scene:add_child(shelves(7.3, 3.2):translate(-3.65, floor_y, back + .4))
scene:add_child(shelves(5.2, 3.2):rotate('y', 90):translate(-3.3, floor_y, -.9))
scene:add_child(shelves(5.2, 3.2):rotate('y', -90):translate(3.3, floor_y, -6.1))

-- a desk with a lamp, open books, a globe; an armchair; a lamp that stands
scene:add_child(gr.box{material = wood, min = {-1.7, -.72, -3.5}, max = {.35, -.66, -2.5}, edge = .015})
for _, x in ipairs{-1.6, .12} do scene:add_child(gr.box{material = wood, min = {x, floor_y, -3.4}, max = {x + .14, -.7, -2.6}}) end
local brass = gr.metal_material{metal = 'brass', roughness = .2}
local shade = gr.openpbr_material{base_color = {.02, .22, .09}, specular_roughness = .08, transmission_weight = .0, emission_luminance = .22, emission_color = {.05, .75, .25}}
scene:add_child(gr.cylinder{material = brass, from = {-.75, -.66, -3.05}, to = {-.75, -.63, -3.05}, radius = .12, edge = .01})
scene:add_child(gr.cylinder{material = brass, from = {-.75, -.64, -3.05}, to = {-.75, -.26, -3.05}, radius = .014})
scene:add_child(gr.difference(gr.cylinder{material = shade, from = {-1.0, -.25, -2.98}, to = {-.5, -.25, -2.98}, radius = .11, edge = .02}, gr.box(shade, {-2, -1, -4}, {2, -.27, 0})))
scene:add_child(gr.box{material = gr.material{kd = {0, 0, 0}, emission = {110, 70, 32}}, min = {-.95, -.285, -3.04}, max = {-.55, -.272, -2.92}})
local paper = gr.openpbr_material{base_color = {.72, .66, .52}, specular_weight = .2}
for s = -1, 1, 2 do scene:add_child(gr.box{material = paper, min = {0, 0, -.15}, max = {.21, .022, .15}, edge = .008}:rotate('z', 5 * s):scale(s, 1, 1):rotate('y', 14):translate(-.42, -.655, -2.78)) end
for k = 0, 3 do scene:add_child(gr.box{material = bindings[k + 1], min = {-.16, 0, -.11}, max = {.16, .045, .11}, edge = .006}:rotate('y', 11 * k):translate(-1.4, -.66 + .045 * k, -2.9)) end
local sea = gr.openpbr_material{coat_weight = .6, specular_roughness = .35, base_color = function(p)
    return gr.mix(gr.vec(.10, .16, .17), gr.vec(.50, .36, .17), gr.smoothstep(.02, .10, gr.noise(p * 5) + .4 * gr.noise(p * 11))) end}
scene:add_child(gr.sphere{material = sea, radius = .24}:translate(.12, -.34, -3.1))
scene:add_child(gr.torus(brass, .262, .012):rotate('x', 90):rotate('z', 23):translate(.12, -.34, -3.1))
scene:add_child(gr.cylinder{material = wood, from = {.12, -.66, -3.1}, to = {.12, -.60, -3.1}, radius = .14, edge = .02})
local leather = gr.openpbr_material{base_color = {.20, .055, .025}, specular_roughness = .38, coat_weight = .2, geometry_normal = gr.bump(function(p) return gr.turbulence(p * 18, 2) end, .006)}
local chair = gr.node 'chair'
chair:add_child(gr.box{material = leather, min = {-.38, .12, -.36}, max = {.38, .48, .40}, edge = .09})
chair:add_child(gr.box{material = leather, min = {-.40, .3, -.52}, max = {.40, 1.18, -.28}, edge = .10}:rotate('x', -7))
for s = -1, 1, 2 do chair:add_child(gr.box{material = leather, min = {s * .44 - .10, .12, -.45}, max = {s * .44 + .10, .70, .42}, edge = .09}) end
scene:add_child(chair:rotate('y', -32):translate(1.75, floor_y, -3.9))
scene:add_child(gr.cylinder{material = brass, from = {2.45, floor_y, -4.7}, to = {2.45, .28, -4.7}, radius = .016})
local silk = gr.openpbr_material{base_color = {.8, .62, .38}, emission_luminance = 3.2, emission_color = {1, .62, .27}}
scene:add_child(gr.cone{material = silk, from = {2.45, .55, -4.7}, to = {2.45, .22, -4.7}, from_radius = .14, radius = .27, open = true})
scene:add_child(gr.sphere{material = gr.material{kd = {0, 0, 0}, emission = {230, 135, 55}}, centre = {2.45, .36, -4.7}, radius = .06})
for _, z in ipairs{-2.2, -4.6} do                 -- a row of globes below the ceiling
    scene:add_child(gr.cylinder{material = brass, from = {.3, ceiling, z}, to = {.3, 1.42, z}, radius = .010})
    scene:add_child(gr.sphere{material = gr.material{kd = {0, 0, 0}, emission = {13, 8.2, 3.9}}, centre = {.3, 1.26, z}, radius = .15})
end
local carpet = gr.openpbr_material{fuzz_weight = .6, fuzz_color = {.5, .2, .15}, specular_weight = 0, base_color = function(p)
    return gr.mix(gr.vec(.20, .025, .02), gr.vec(.05, .04, .10), gr.smoothstep(.1, .2, gr.noise(p.x * 6, 0, p.z * 6))) end}
scene:add_child(gr.box{material = carpet, min = {-2.4, floor_y, -5}, max = {2.4, floor_y + .012, -1.2}})

local night = {.012, .020, .038}
gr.render{node = scene, file = 'library.png', width = 1600, height = 1000, eye = {.18, .02, 2.35}, target = {-.02, -.10, -1}, fov = 44, aperture = .011, focus_point = {0, 0, 0},
    integrator = 'path', denoise = true, tone = 'filmic', exposure = 2.6, clamp = 10, max_depth = 10, vignette = .25, background = night, bloom = .05,
    lights = {gr.area_light{corner = {-.95, -.29, -3.04}, v1 = {.4, 0, 0}, v2 = {0, 0, .12}, emission = {110, 70, 32}}, gr.sky_light{sky = night}}}
