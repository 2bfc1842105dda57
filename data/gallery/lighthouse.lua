-- TITLE: The lighthouse
-- OPTIONS: --size 300x375 --spp 4
-- LARGE: --spp 88
-- Fog over a rock in the sea, at dusk: the lens of the lamp sends two beams into it, and the windows of the keeper glow. The fog
-- is a medium that ends above the lamp, and all light in it is scattered light.
local random = require 'random'
local scene = gr.node 'coast'
local dice = random.new(6)
local function glow(r, g, b) return gr.material{kd = {0, 0, 0}, emission = {r, g, b}} end

-- the rock: a height field with ledges, wet near the water
local function ground(x, z)
    local d = ((x * .8) ^ 2 + (z * .95) ^ 2) ^ .5
    local rough = gr.noise(x * .33, 0, z * .33) * 1.5 + gr.noise(x * .9, 1, z * .9) * .55 + .22 * gr.noise(x * 2.6, 2, z * 2.6) + .07 * gr.noise(x * 8, 3, z * 8)
    local h = 4.0 * gr.smoothstep(8.5, 2.2, d + .9 * gr.noise(x * .45, 4, z * .45)) - 1.5
    local ledge = h + rough * gr.smoothstep(1.8, 4.5, d)
    local stepped = ledge * 1.6 // 1 / 1.6
    return gr.mix(ledge, stepped + .18 * (ledge - stepped), .55 * gr.smoothstep(1.8, 3.5, d))
end
local rock = gr.openpbr_material{
    base_color = function(p) return gr.mix(gr.vec(.16, .14, .12), gr.vec(.055, .05, .047), gr.clamp(gr.turbulence(p * 26, 4), 0, 1)) end,
    specular_roughness = function(p) return gr.mix(.22, .6, gr.smoothstep(-.01, .05, p.y)) end,
    geometry_normal = gr.bump(function(p) return gr.turbulence(p * 60, 3) end, .004)}
scene:add_child(gr.height_field{material = rock, columns = 700, smooth = true, open = true, f = function(p) return ground((p.x - .5) * 26, (p.z - .5) * 26) / 26 end}
    :translate(-.5, 0, -.5):scale(26, 26, 26))
for _ = 1, 26 do                                   -- skerries
    local a, d = dice:range(0, 2 * math.pi), dice:range(8, 13)
    local r = dice:range(.25, .9)
    scene:add_child(gr.ellipsoid{material = rock, centre = {d * math.cos(a), -.25 * r, d * math.sin(a)}, radii = {r * dice:range(.8, 1.5), r * dice:range(.4, .8), r}})
end
-- the sea: swell and ripples as a bump, foam around the rock
local sea = gr.openpbr_material{specular_ior = 1.333,
    base_color = function(p)
        local shore = gr.clamp((ground(p.x, p.z) + 1.15) / .9, 0, 1)
        local foam = gr.smoothstep(.25, .7, shore + .55 * gr.noise(p.x * 2.4, 5, p.z * 2.4)) * gr.smoothstep(-.25, .35, gr.noise(p.x * 6, 6, p.z * 6))
        return gr.mix(gr.vec(.006, .017, .020), gr.vec(.50, .53, .55), foam)
    end,
    specular_roughness = .10, geometry_normal = gr.bump(function(p)
        return .10 * gr.noise(p.x * .7, 0, p.z * 1.1) + .05 * gr.noise(p.x * 1.9, 1, p.z * 2.4) + .018 * gr.noise(p.x * 5, 2, p.z * 6) + .006 * gr.noise(p.x * 13, 3, p.z * 15) end, 1)}
scene:add_child(gr.plane{material = sea, normal = {0, 1, 0}})

-- the tower: whitewashed, with a red band, weather on the plaster
local base, top = 2.0, 10.6
local lime = gr.openpbr_material{specular_roughness = .6, base_color = function(p)
    local streak = gr.smoothstep(.0, .6, gr.noise(p.x * 3.2, p.y * .28, p.z * 3.2)) * .35 + .14 * gr.turbulence(p * 1.8, 3)
    local band = gr.smoothstep(6.30, 6.32, p.y) * gr.smoothstep(8.0, 7.98, p.y)
    return gr.mix(gr.vec(.70, .68, .63), gr.vec(.42, .035, .03), band) * (1 - streak)
end}
local iron = gr.openpbr_material{base_color = {.035, .04, .042}, specular_roughness = .4}
scene:add_child(gr.lathe(lime, {{0, base - 1}, {1.55, base - 1}, {1.5, base + .1}, {1.22, base + 2.4}, {1.02, base + 5}, {.90, top - .5}, {.92, top - .25}, {1.12, top}, {0, top}}, 'linear'))
scene:add_child(gr.cylinder{material = iron, from = {0, top, 0}, to = {0, top + .10, 0}, radius = 1.32, edge = .03})
for k = 0, 19 do
    local a = 2 * math.pi * k / 20
    scene:add_child(gr.cylinder{material = iron, from = {1.26 * math.cos(a), top + .1, 1.26 * math.sin(a)}, to = {1.26 * math.cos(a), top + .62, 1.26 * math.sin(a)}, radius = .016})
end
for _, y in ipairs{.36, .62} do scene:add_child(gr.torus(iron, 1.26, .02):translate(0, top + y, 0)) end
scene:add_child(gr.cylinder{material = lime, from = {0, top + .1, 0}, to = {0, top + .45, 0}, radius = .68})
for k = 0, 9 do                                    -- lantern bars, roof, ball and vane
    local a = 2 * math.pi * (k + .5) / 10
    scene:add_child(gr.cylinder{material = iron, from = {.64 * math.cos(a), top + .4, .64 * math.sin(a)}, to = {.64 * math.cos(a), top + 1.65, .64 * math.sin(a)}, radius = .022})
end
scene:add_child(gr.lathe(iron, {{0, top + 1.63}, {.80, top + 1.63}, {.80, top + 1.70}, {.62, top + 1.98}, {.30, top + 2.22}, {.08, top + 2.34}, {.05, top + 2.62}, {0, top + 2.64}}, 'linear'))
scene:add_child(gr.sphere{material = iron, centre = {0, top + 2.62, 0}, radius = .12})
scene:add_child(gr.cylinder{material = iron, from = {0, top + 2.6, 0}, to = {0, top + 3.3, 0}, radius = .014})
local lamp = {0, top + 1.05, 0}
scene:add_child(gr.sphere{material = glow(46, 34, 19), centre = lamp, radius = .23})
local function radius(y) return y < 4.4 and 1.5 - .122 * (y - 2.1) or y < 7 and 1.22 - .077 * (y - 4.4) or 1.02 - .039 * (y - 7) end
for _, w in ipairs{{3.6, 20}, {5.6, -35}, {8.7, 12}} do   -- windows of the stair
    local r, a = radius(w[1]), math.rad(90 + w[2])
    scene:add_child(gr.box{material = glow(3.2, 1.7, .6), min = {-.13, -.22, -.1}, max = {.13, .22, .04}}:rotate('y', -w[2]):translate(r * math.cos(a), w[1], r * math.sin(a)))
end

-- the keeper's house, and steps to a landing
local slate = gr.openpbr_material{base_color = {.05, .052, .06}, specular_roughness = .45}
local house = gr.node 'house'
house:add_child(gr.box{material = lime, min = {-1.3, -.8, -.85}, max = {1.3, 1.15, .85}})
house:add_child(gr.prism{material = slate, outline = {{-1.0, 0}, {1.0, 0}, {0, .95}}, from = -1.42, to = 1.42}:rotate('x', -90):rotate('y', 90):translate(0, 1.12, 0))
house:add_child(gr.box{material = lime, min = {.75, 1.2, -.2}, max = {1.1, 2.35, .15}})
for _, x in ipairs{-.75, .55} do house:add_child(gr.box{material = glow(3.6, 1.9, .65), min = {x - .2, .25, .8}, max = {x + .2, .8, .87}}) house:add_child(gr.box{material = iron, min = {x - .015, .25, .86}, max = {x + .015, .8, .89}}) house:add_child(gr.box{material = iron, min = {x - .2, .51, .86}, max = {x + .2, .54, .89}}) end
house:add_child(gr.box{material = iron, min = {-.28, -.6, .8}, max = {.12, .62, .88}})
scene:add_child(house:rotate('y', -18):translate(2.75, base + .55, 1.0))
-- a boat with a lantern
local hull = gr.openpbr_material{base_color = {.05, .09, .12}, specular_roughness = .3}
local boat = gr.node 'boat'
boat:add_child(gr.difference(gr.ellipsoid{material = hull, centre = {0, .25, 0}, radii = {1.25, .42, .42}}, gr.box(hull, {-2, .25, -1}, {2, 2, 1}), gr.ellipsoid{material = hull, centre = {0, .3, 0}, radii = {1.1, .34, .34}}))
boat:add_child(gr.cylinder{material = iron, from = {.2, 0, 0}, to = {.2, 1.25, 0}, radius = .025})
boat:add_child(gr.sphere{material = glow(13, 6.5, 2), centre = {.2, 1.3, 0}, radius = .07})
scene:add_child(boat:rotate('z', 4):rotate('y', 24):translate(-4.4, .02, 9.2))

local sky = gr.sky_gradient{{-1, .006, .01, .014}, {0, .085, .095, .115}, {.25, .040, .060, .095}, {1, .012, .022, .050}}
local aim = gr.vec(.96, -.05, .22):normalize()
gr.render{node = scene, file = 'lighthouse.png', width = 1200, height = 1500, eye = {-4.2, 2.1, 25}, target = {.35, 6.2, 0}, fov = 36,
    integrator = 'path', denoise = true, tone = 'filmic', exposure = 1.7, clamp = 2.5, max_depth = 6, vignette = .2, background = sky,
    medium = gr.medium{albedo = {.92, .94, .96}, distance = 55, g = .5, top = 21},
    lights = {gr.spot_light{position = gr.vec(lamp) + aim * .26, direction = aim, colour = {1, .88, .66}, outer = 6.5, intensity = 4200},
        gr.spot_light{position = gr.vec(lamp) - aim * .26, direction = -aim, colour = {1, .88, .66}, outer = 6.5, intensity = 4200}, gr.sky_light{sky = sky}}}
