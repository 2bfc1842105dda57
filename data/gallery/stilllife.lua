-- TITLE: Still life with lemons
-- OPTIONS: --size 400x250 --spp 10
-- LARGE: --spp 96
-- A window on the left, a dark wall, and what Dutch painters laid on a table: a white cloth with folds, pewter, a glass of
-- wine, lemons, grapes and bread. Grapes and lemons scatter light inside.
local random, patterns = require 'random', require 'patterns'
local scene = gr.node 'still life'
local dice = random.new(14)

-- the table, the wall, the cloth: a fall of folds over the edge, creases from the cupboard on top
local oak = gr.openpbr_material{specular_roughness = .42, base_color = function(p)
    local grain = patterns.wood(gr.vec(p.y * .5, p.z * .7, p.x * .1) + gr.vec(1.2, .4, 0))
    return gr.mix(gr.vec(.16, .075, .035), gr.vec(.06, .026, .012), grain) * (.8 + .3 * gr.noise(p.x * .7, 1, p.z * 24))
end}
scene:add_child(gr.box{material = oak, min = {-9, -.35, -2.6}, max = {9, 0, 2.5}, edge = .06})
local wall = gr.openpbr_material{specular_roughness = .8, base_color = function(p)
    return gr.vec(.145, .125, .098) * (1 - .35 * gr.turbulence(p * .7, 4)) end}
scene:add_child(gr.plane{material = wall, normal = {0, 0, 1}, distance = -4.4})
local linen = gr.openpbr_material{base_color = function(p)
        local weave = gr.noise(p.x * 420, 0, p.z * 60) + gr.noise(p.x * 60, 1, p.z * 420)
        local seam = gr.smoothstep(.0022, .0012, gr.max(p.z - .965, .965 - p.z)) * gr.smoothstep(.25, .35, p.x * 150 % 1)
        return gr.vec(.78, .75, .68) * (1 + .05 * weave) * (1 - .14 * seam)
    end, specular_weight = .2, specular_roughness = .7, fuzz_weight = .25, fuzz_color = {.9, .88, .84}}
local function fold(x, z)                          -- height over the table; z from the back, 0 to 4.9
    local wave = .10 * math.sin(3.1 * x + 1.1 * gr.noise(x, 3, z * .4) * 3) + .07 * math.sin(7.3 * x + 2 * gr.noise(x * .8, 5, z * .3))
    local crest = gr.max(0, gr.noise(x * 1.3 - z * .8, 7, z * .35 + x * .2)) ^ 1.5
    return .03 + .30 * crest * gr.smoothstep(.1, .9, z) + (wave + .17) * gr.smoothstep(2.2, 3.8, z) + .01 * gr.noise(x * 6, 2, z * 6)
end
scene:add_child(gr.height_field{material = linen, columns = 560, rows = 560, smooth = true, open = true, f = function(p)
    local x, z = p.x * 5.4, p.z * 4.9
    local over = gr.max(0, z - 3.85)
    return (fold(x, z) - .5 * over * over * 5) / 5.4
end}:translate(-.5, 0, 0):scale(5.4, 5.4, 4.9):rotate('y', 7):translate(.75, 0, -1.25))

-- a jug of pewter
local pewter = gr.metal_material{metal = 'nickel', roughness = function(p) return .22 + .16 * gr.turbulence(p * 2.5, 4) end,
    normal = gr.bump(function(p) return gr.noise(p.x * 3, p.y * 9, p.z * 3) + .4 * gr.noise(p * 14) end, .010)}
local jug = gr.node 'jug'
jug:add_child(gr.lathe(pewter, {{0, .02}, {.46, .02}, {.50, .06}, {.47, .12}, {.42, .17}, {.55, .35}, {.66, .65}, {.64, .95}, {.50, 1.25}, {.36, 1.50}, {.31, 1.70}, {.33, 1.90}, {.40, 2.08}, {.41, 2.12}, {.38, 2.12}, {.30, 1.92}, {.27, 1.70}, {0, 1.6}}, 'catmull-rom'))
jug:add_child(gr.torus(pewter, .325, .022):translate(0, 1.66, 0)):add_child(gr.torus(pewter, .655, .018):translate(0, .72, 0))
jug:add_child(gr.sweep(pewter, {{.36, 1.98, 0}, {.62, 2.06, 0}, {.88, 1.80, 0}, {.94, 1.40, 0}, {.84, 1.0, 0}, {.64, .82, 0}}, {.05, .06, .055, .05, .05, .06}))
scene:add_child(jug:rotate('y', -28):translate(-1.55, 0, -.85))

-- a glass of red wine
local glass = gr.openpbr_material{transmission_weight = 1, specular_roughness = 0, specular_ior = 1.5}
local wine = gr.openpbr_material{transmission_weight = 1, transmission_color = {.42, .012, .022}, transmission_depth = .35, specular_roughness = 0, specular_ior = 1.34}
local goblet = gr.node 'goblet'
goblet:add_child(gr.lathe(glass, {{0, .02}, {.40, .02}, {.41, .04}, {.20, .08}, {.07, .14}, {.055, .30}, {.10, .42}, {.055, .54}, {.06, .78}, {.20, .90}, {.40, 1.12}, {.47, 1.40}, {.44, 1.68}, {.40, 1.88}, {.39, 1.89}, {.38, 1.88}, {.42, 1.66}, {.45, 1.40}, {.385, 1.13}, {.19, .935}, {0, .88}}, 'catmull-rom'))
goblet:add_child(gr.lathe(wine, {{0, .882}, {.188, .938}, {.382, 1.132}, {.447, 1.40}, {.446, 1.42}, {0, 1.42}}))
scene:add_child(goblet:translate(-.15, 0, -.95))

-- lemons: one whole, one cut
local pores = gr.bump(function(p) local d = gr.cells(p * 32) return gr.smoothstep(.4, .05, d) * -1 + gr.noise(p * 3) end, .005)
local peel = gr.openpbr_material{subsurface_weight = .6, subsurface_color = {.90, .60, .05}, subsurface_radius = .05, subsurface_radius_scale = {1, .7, .2},
    base_color = function(p) return gr.mix(gr.vec(.86, .56, .03), gr.vec(.80, .62, .10), gr.turbulence(p * 1.6, 3)) end, specular_roughness = .30, geometry_normal = pores}
local flesh = gr.openpbr_material{subsurface_weight = .2, subsurface_color = {.92, .76, .26}, subsurface_radius = .05, specular_roughness = .15, coat_weight = .4,
    base_color = function(p)
        local r = (p.x * p.x + p.z * p.z) ^ .5
        local a = math.atan(p.z, p.x)                    -- juice sacs point to the middle
        local sector = 1
        for k = 0, 4 do
            local c, s = math.cos(math.pi * k / 5 + .2), math.sin(math.pi * k / 5 + .2)
            sector = gr.min(sector, gr.smoothstep(.004, .016 + .01 * gr.noise(p * 9), gr.max(p.x * s - p.z * c, p.z * c - p.x * s)))
        end
        local pulp = gr.mix(gr.vec(.82, .55, .10), gr.vec(.55, .32, .02), .5 + .45 * gr.noise(r * 9, math.sin(a) * 13, math.cos(a) * 13) + .2 * gr.noise(p * 40))
        return gr.mix(gr.vec(.88, .84, .62), gr.mix(gr.vec(.88, .84, .62), pulp, sector), gr.smoothstep(.425, .40, r) * gr.smoothstep(.03, .06, r))
    end}
local lemon = {{0, -.68}, {.05, -.67}, {.10, -.61}, {.24, -.52}, {.40, -.30}, {.465, 0}, {.42, .27}, {.26, .50}, {.13, .59}, {.10, .64}, {.06, .665}, {0, .67}}
scene:add_child(gr.lathe(peel, lemon, 'catmull-rom'):rotate('z', 78):rotate('y', 35):translate(1.35, .50, .35))
scene:add_child(gr.lathe(peel, lemon, 'catmull-rom'):rotate('z', 96):rotate('y', -50):translate(2.05, .52, -.55))
local half = gr.node 'half'
half:add_child(gr.intersection(gr.lathe(peel, lemon, 'catmull-rom'), gr.box(flesh, {-1, -1, -1}, {1, 0, 1})))
scene:add_child(half:rotate('x', 62):rotate('y', -24):translate(.52, .47, .98))

-- grapes on a stalk
local function grape_of(r, g, b)
    return gr.openpbr_material{subsurface_weight = .85, subsurface_color = {r, g, b}, subsurface_radius = .09, subsurface_radius_scale = {1, .6, .6}, specular_roughness = function(p) return .18 + .25 * gr.turbulence(p * 5, 3) end,
        base_color = {r, g, b}, coat_weight = .3, coat_roughness = .25}
end
local kinds = {grape_of(.10, .018, .055), grape_of(.15, .022, .06), grape_of(.065, .015, .06)}
local stalk = gr.openpbr_material{base_color = {.16, .12, .04}, specular_roughness = .6}
local placed = {}
for _ = 1, 2600 do
    local t = dice:range(0, 1)
    local radius, spread = dice:range(.135, .165), .50 * (1 - t) ^ .6 + .08
    local a, q = dice:range(0, 2 * math.pi), dice:range(0, 1) ^ .5
    local c = {-.75 - 1.35 * t + spread * q * math.cos(a) * .6, 0, 1.05 + .35 * t + spread * q * math.sin(a)}
    c[2] = radius + .06 + dice:range(0, .62) * (1 - t) * (1 - q * q)
    local free = true
    for _, g in ipairs(placed) do free = free and (g[1] - c[1]) ^ 2 + (g[2] - c[2]) ^ 2 + (g[3] - c[3]) ^ 2 > (.93 * (g[4] + radius)) ^ 2 end
    if free and #placed < 58 then
        placed[#placed + 1] = {c[1], c[2], c[3], radius}
        scene:add_child(gr.ellipsoid{material = kinds[dice:number() < .5 and 1 or (dice:number() < .5 and 2 or 3)], centre = c, radii = {radius, radius * dice:range(1.0, 1.12), radius}})
    end
end
scene:add_child(gr.sweep(stalk, {{-1.05, .34, 1.05}, {-.72, .50, 1.06}, {-.40, .36, 1.02}, {-.12, .15, .98}, {-.06, .13, .97}}, {.022, .026, .028, .034, .042}))

-- bread, and a knife over the edge
local crust = gr.openpbr_material{specular_roughness = .55, specular_weight = .5, base_color = function(p)
        local flour = gr.smoothstep(.15, .5, gr.noise(p * 2.2) + .5 * gr.noise(p * 9))
        return gr.mix(gr.mix(gr.vec(.62, .34, .13), gr.vec(.36, .15, .05), gr.turbulence(p * 2, 3)), gr.vec(.70, .60, .46), .55 * flour)
    end, geometry_normal = gr.bump(function(p) return gr.turbulence(p * 3, 4) end, .05)}
scene:add_child(gr.difference(gr.ellipsoid{material = crust, centre = {0, 0, 0}, radii = {.95, .48, .62}}, gr.torus(crust, 1.3, .07):rotate('x', 90):translate(-.25, -.93, .02), gr.torus(crust, 1.3, .07):rotate('x', 90):translate(.30, -.93, .02)):rotate('y', 24):translate(3.05, .42, -1.25))
local steel = gr.metal_material{metal = 'chromium', roughness = function(p) return .14 + .12 * gr.noise(p.x * 4, p.y * 4, p.z * 50) end}
local bone = gr.openpbr_material{base_color = {.62, .52, .36}, specular_roughness = .3, subsurface_weight = .4, subsurface_color = {.7, .6, .4}, subsurface_radius = .03}
local knife = gr.node 'knife'
knife:add_child(gr.prism{material = steel, outline = {{0, -.11}, {1.25, -.11}, {1.5, -.02}, {1.3, .07}, {0, .09}}, from = 0, to = .018, edge = .006})
knife:add_child(gr.sweep(bone, {{-.05, .01, 0}, {-.4, .015, .01}, {-.8, .01, -.01}}, {.055, .075, .09}))
scene:add_child(knife:rotate('y', -32):translate(-2.75, .045, 1.15))

local cool = {.032, .040, .052}
gr.render{node = scene, file = 'stilllife.png', width = 1600, height = 1000, eye = {.35, 2.15, 9.6}, target = {.42, .72, 0}, fov = 26, aperture = .05, focus_point = {.4, .7, .8},
    integrator = 'path', denoise = true, tone = 'filmic', exposure = .45, clamp = 10, max_depth = 12, vignette = .3, background = cool,
    lights = {gr.area_light{corner = {-9, 1.6, -1.5}, v1 = {0, 0, 5}, v2 = {0, 4.2, 0}, emission = {12, 11, 9.4}}, gr.sky_light{sky = cool}}}
