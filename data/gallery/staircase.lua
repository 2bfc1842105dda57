-- TITLE: The red stairs
-- OPTIONS: --size 320x400 --spp 4
-- LARGE: --spp 48
-- A spiral staircase from above: daylight falls from a skylight down the well, and a lamp waits on the marble at the bottom.
-- 120 steps with rounded noses, a carpet that folds over them, brass rods, iron balusters and a handrail of oak.
local materials = require 'materials'
local steps, turn, rise = 120, 15, .17             -- the angle and the height of a step: 24 steps in a storey
local well, wall = 1.15, 3                          -- the radii of the well and of the wall
local scene = gr.node 'stairs'

-- plaster with the waves of the trowel, and a darker band at the height of hands
local plaster = gr.openpbr_material{specular_roughness = .6, specular_weight = .5,
    base_color = function(p) return gr.vec(.80, .75, .66) * (1 - .12 * gr.turbulence(p * .7, 3)) end,
    geometry_normal = gr.bump(function(p) return gr.noise(p * 4) end, .01)}
local stone = gr.openpbr_material{specular_roughness = .45, base_color = function(p)
    local worn = gr.smoothstep(.5, 0, gr.length(gr.vec(p.x, 0, p.z)) - 1.3)
    return gr.mix(gr.vec(.62, .55, .45), gr.vec(.44, .38, .31), .5 * gr.turbulence(p * 5, 3) + .3 * worn)
end}
local iron = gr.openpbr_material{base_color = {.03, .03, .032}, specular_roughness = .6}
local brass = gr.metal_material{metal = 'brass', roughness = function(p) return .16 + .14 * gr.turbulence(p * 9, 3) end}
-- oak whose grain follows the rail: fine across it, long along it; v is the height over the rail's middle
local oak = gr.openpbr_material{specular_roughness = .55, specular_weight = .6, base_color = function(p)
    local r, v = (p.x ^ 2 + p.z ^ 2) ^ .5 - 1.22, p.y - math.atan(p.z, p.x) * rise / math.rad(turn) - .92
    v = (v + .5) % (24 * rise) - .5
    local grain = gr.noise(r * 60, v * 60, p.y * 1.5) + .5 * gr.noise(r * 170, v * 170, p.y * 4)
    return gr.mix(gr.vec(.25, .125, .055), gr.vec(.135, .062, .027), gr.smoothstep(-.6, .7, grain))
end}
local carpet = gr.openpbr_material{fuzz_weight = .7, fuzz_color = {.75, .10, .09}, fuzz_roughness = .6, specular_weight = 0,
    base_color = function(p)
        local radius = (p.x ^ 2 + p.z ^ 2) ^ .5
        local border = gr.smoothstep(.02, .03, gr.min(radius - 1.66, 2.44 - radius))
        local band = gr.smoothstep(.025, .035, gr.min(radius - 1.72, 2.38 - radius))
        local worn = 1 + .35 * gr.turbulence(p * 14, 3) - .1
        return gr.mix(gr.vec(.36, .012, .018), gr.vec(.62, .42, .12), border * (1 - band)) * worn
    end}

-- a ring's sector as an outline for gr.prism
local function sector(inner, outer, from, to)
    local points = {}
    for k = 0, 5 do local a = math.rad(from + (to - from) * k / 5) points[#points + 1] = {outer * math.cos(a), outer * math.sin(a)} end
    for k = 5, 0, -1 do local a = math.rad(from + (to - from) * k / 5) points[#points + 1] = {inner * math.cos(a), inner * math.sin(a)} end
    return points
end
local function at(radius, degrees, y) return {radius * math.cos(math.rad(degrees)), y, radius * math.sin(math.rad(degrees))} end

-- one step, whose copies turn and rise
local step = gr.node 'step'
step:add_child(gr.prism{material = stone, outline = sector(well, wall + .1, 0, turn + 1.2), from = -.05, to = 0, edge = .015})
step:add_child(gr.prism{material = stone, outline = sector(well, wall + .1, .2, turn + .8), from = -.32, to = -.016})
step:add_child(gr.prism{material = carpet, outline = sector(1.64, 2.46, -.15, turn + .4), from = -.02, to = .014})
step:add_child(gr.prism{material = carpet, outline = sector(1.64, 2.46, -.25, .3), from = -rise, to = .012})
step:add_child(gr.cylinder{material = brass, from = at(1.58, turn - .4, .03), to = at(2.52, turn - .4, .03), radius = .016})
for _, r in ipairs{1.57, 2.53} do step:add_child(gr.sphere{material = brass, centre = at(r, turn - .4, .03), radius = .028}) end
for k = 0, 1 do
    local a = 3.5 + 7.5 * k
    step:add_child(gr.cylinder{material = iron, from = at(1.22, a, 0), to = at(1.22, a, .95 + .085 * k), radius = .014})
    step:add_child(gr.sphere{material = iron, centre = at(1.22, a, .5 + .085 * k), radius = .034})
    step:add_child(gr.cylinder{material = iron, from = at(1.22, a, -.01), to = at(1.22, a, .022), radius = .036, edge = .008})
    step:add_child(gr.cone{material = iron, from = at(1.22, a, .02), to = at(1.22, a, .075), from_radius = .028, radius = .014})
end
local rail, string = {}, {}
for i = 0, steps - 1 do
    scene:add_child(gr.node{children = {step}}:rotate('y', -turn * i):translate(0, rise * i, 0))
    rail[i + 1], string[i + 1] = at(1.22, turn * i + 5.5, rise * i + .98), at(well + .02, turn * i + 7, rise * i - .26)
end
scene:add_child(gr.sweep(oak, rail, .045))
scene:add_child(gr.sweep(plaster, string, .15))
scene:add_child(gr.cylinder{material = plaster, from = {0, -1, 0}, to = {0, steps * rise + 2, 0}, radius = wall, open = true})

-- the floor: a star of two marbles, and the lamp
local light, dark = materials.named('white marble', {scale = 2}), materials.named('black marble', {scale = 2})
scene:add_child(gr.cylinder{material = light, from = {0, -.6, 0}, to = {0, -.4, 0}, radius = wall})
for k = 0, 15 do scene:add_child(gr.prism{material = dark, outline = sector(.45, wall, 22.5 * k, 22.5 * k + 11.25), from = -.5, to = -.399}) end
scene:add_child(gr.lathe(brass, {{0, -.4}, {.34, -.4}, {.3, -.33}, {.1, -.28}, {.05, 0}, {.05, .35}, {.16, .42}, {0, .45}}))
scene:add_child(gr.sphere{material = gr.material{kd = {0, 0, 0}, emission = {46, 25, 9}}, centre = {0, .68, 0}, radius = .25})

gr.render{node = scene, file = 'staircase.png', width = 1280, height = 1600, eye = {.42, 20.1, .30}, target = {-.1, 0, -.15}, up = {.5, 0, -1}, fov = 66,
    integrator = 'path', denoise = true, tone = 'filmic', exposure = .15, clamp = 12, max_depth = 8, vignette = .2,
    background = {.7, .8, 1}, lights = {gr.disc_light{position = {0, steps * rise + 1.9, 0}, normal = {0, -1, 0}, radius = 2.6, emission = {1.5, 1.75, 2.2}}}}
