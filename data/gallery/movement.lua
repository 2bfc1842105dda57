-- TITLE: The movement of a watch
-- OPTIONS: --size 400x250 --spp 6
-- LARGE: --spp 64
-- Going train, balance and hairspring over a plate with stripes. Bridges and wheels are prisms with bevelled edges, whose
-- polished bevels catch the strips of light; jewels of ruby sit in gold; screws are blued. One unit is two millimetres.
-- With --frames 96 --loop it runs, slower than a watch: ten beats in four seconds.
-- LOOP: --frames 96 --fps 24 --loop --size 800x500 --spp 16
local gear = require 'gear'
local scene = gr.node 'movement'
local beats = 10 * (gr.clock or 0)
local swing = 80 * math.sin(math.pi * beats)       -- of the balance, in degrees
local step = beats // 1 + gr.smoothstep(0, .3, beats % 1)   -- the escapement lets the train go a little at each beat
local function scratched(base, depth)              -- hairlines and fingerprints in the polish
    return function(p) return base + depth * gr.turbulence(gr.vec(p.x * 3, p.y * 3, p.z * 3), 3) + .5 * depth * gr.noise(p.x * 60, p.y * 3, p.z * 4) end
end
-- stripes: each is a little inclined, as the wheel of the grinder leaves it
local function stripes(direction, width)
    return gr.bump(function(p)
        local s = (p.x * direction[1] + p.z * direction[2]) / width
        local t = s - s // 1
        return width * .055 * (t - t * t) + .0006 * gr.noise(p.x * direction[2] * 90 - p.z * direction[1] * 90 + 40 * t, s * .2, 0)
    end, 1)
end
local nickel = gr.metal_material{metal = 'nickel', roughness = scratched(.20, .05), normal = stripes({.8, .6}, .52)}
local perlage = gr.metal_material{metal = 'nickel', roughness = .30, normal = gr.bump(function(p)   -- overlapping round strokes
    local a, b = gr.vec((p.x * 2.6 + .5) % 1 - .5, 0, (p.z * 2.6 + .5) % 1 - .5), gr.vec((p.x * 2.6) % 1 - .5, 0, (p.z * 2.6) % 1 - .5)
    return .006 * gr.max(gr.smoothstep(.46, .1, gr.length(a)), .9 * gr.smoothstep(.46, .1, gr.length(b)))
end, 1)}
local brass = gr.metal_material{metal = 'brass', roughness = scratched(.20, .06)}
local gold = gr.metal_material{metal = 'gold', roughness = .14}
local steel = gr.metal_material{metal = 'chromium', roughness = scratched(.10, .05)}
local polished = gr.metal_material{metal = 'chromium', roughness = .05}
local blued = gr.openpbr_material{base_color = {.035, .075, .42}, base_metalness = 1, specular_color = {.5, .6, 1}, specular_roughness = .14}
local ruby = gr.openpbr_material{base_color = {.55, .01, .06}, transmission_weight = .75, transmission_color = {.80, .02, .12}, transmission_depth = .22, specular_ior = 1.76, specular_roughness = 0}

-- an arbor with its jewel in a chaton
local function jewel(x, y, z, r)
    scene:add_child(gr.difference(gr.cylinder{material = gold, from = {x, y - .1, z}, to = {x, y + .035, z}, radius = 1.55 * r, edge = .018},
        gr.cylinder{material = gold, from = {x, y - .02, z}, to = {x, y + 1, z}, radius = 1.12 * r}))
    scene:add_child(gr.difference(gr.cylinder{material = ruby, from = {x, y - .06, z}, to = {x, y + .02, z}, radius = 1.1 * r, edge = .015},
        gr.ellipsoid{material = ruby, centre = {x, y + .05, z}, radii = {.55 * r, .09, .55 * r}}, gr.cylinder{material = ruby, from = {x, y - 1, z}, to = {x, y + 1, z}, radius = .22 * r}))
    scene:add_child(gr.cylinder{material = polished, from = {x, y - .3, z}, to = {x, y + .012, z}, radius = .17 * r, edge = .01})
end
local function screw(x, y, z, r, turn)
    scene:add_child(gr.difference(gr.cylinder{material = blued, from = {x, y - .1, z}, to = {x, y + .09, z}, radius = r, edge = .028},
        gr.box(blued, {-2 * r, y + .035, -.16 * r}, {2 * r, y + 1, .16 * r}):rotate('y', turn):translate(x, 0, z)))
    scene:add_child(gr.torus(polished, 1.12 * r, .03):translate(x, y + .002, z))
end
-- a wheel with spokes: the teeth and windows are one outline
local function wheel(teeth, module, x, y, z, spokes, turn, material)
    local g = gear.new{teeth = teeth, module = module}
    local holes, inner, outer = {gear.circle(.10)}, .30 * g.radius, .80 * g.radius
    for s = 0, spokes - 1 do
        local hole, half = {}, 2 * math.pi / spokes / 2
        for k = -8, 8 do local a = 2 * half * s + (half - .075 / outer * 1.3) * k / 8 hole[#hole + 1] = {outer * math.cos(a), outer * math.sin(a)} end
        for k = 6, -6, -1 do local a = 2 * half * s + (half - .075 / inner * 1.3) * k / 6 hole[#hole + 1] = {inner * math.cos(a), inner * math.sin(a)} end
        holes[#holes + 1] = hole
    end
    local node = gr.node 'wheel'
    node:add_child(gr.prism{material = material or brass, outline = gear.outline(g, 5), holes = holes, from = -.045, to = .045})
    node:add_child(gr.cylinder{material = material or brass, from = {0, -.07, 0}, to = {0, .08, 0}, radius = .62 * inner, edge = .015})
    node:add_child(gr.difference(gr.cylinder{material = polished, from = {0, .04, 0}, to = {0, .058, 0}, radius = .93 * g.radius, edge = .006},
        gr.cylinder{material = polished, from = {0, 0, 0}, to = {0, 1, 0}, radius = .85 * g.radius}))
    scene:add_child(node:rotate('y', turn):translate(x, y, z))
    scene:add_child(gr.cylinder{material = polished, from = {x, y - .5, z}, to = {x, y + .36, z}, radius = .085})
    return g
end
-- a bridge: a smooth outline with bevelled edges
local function bridge(outline, from, to, holes)
    scene:add_child(gr.prism{material = nickel, outline = outline, holes = holes, spline = 'catmull-rom', from = from, to = to, edge = .045})
end

-- the main plate
scene:add_child(gr.difference(gr.cylinder{material = perlage, from = {0, -.7, 0}, to = {0, 0, 0}, radius = 9.2, edge = .05},
    gr.cylinder{material = perlage, from = {2.35, -.35, 1.15}, to = {2.35, 1, 1.15}, radius = 2.05}))
-- the barrel and the train
wheel(72, .085, -4.1, .34, -.6, 6, 2)
wheel(60, .07, -.35, .56, -2.15, 5, 9)
wheel(48, .065, -.75, .30, 1.55, 6, 3 - 6 * step)
wheel(15 + 5, .065, 1.35, .46, 3.1, 4, 9 * step, steel)
scene:add_child(gr.prism{material = steel, outline = gear.outline(gear.new{teeth = 18, module = .07}, 5), from = .1, to = .32}:translate(-2.3, .2, -2.75))

-- bridges, jewels, screws
bridge({{-6.8, -4.6}, {-4.5, -5.1}, {-2.2, -4.6}, {.4, -4.7}, {1.6, -3.7}, {1.2, -2.3}, {-.4, -1.5}, {-1.5, -2.2}, {-2.9, -2.5}, {-4.0, -1.6}, {-4.0, -.3}, {-5.0, .2}, {-6.3, -1.2}}, .72, 1.02)
jewel(-.30, 1.02, -2.3, .16) jewel(-4.55, 1.02, -.65, .17) jewel(-2.4, 1.02, -3.35, .14)
screw(-5.6, 1.02, -3.9, .25, 35) screw(.55, 1.02, -3.9, .25, 110) screw(-5.3, 1.02, -1.3, .18, 70)
bridge({{-4.2, 2.1}, {-2.6, 1.55}, {-1.2, 1.0}, {-.4, 1.2}, {-.3, 2.0}, {.6, 2.7}, {1.6, 2.6}, {1.95, 3.3}, {1.2, 4.0}, {-.8, 4.1}, {-2.6, 4.3}, {-4.2, 3.5}}, .60, .90)
jewel(-.75, .90, 1.6, .15) jewel(1.33, .90, 3.15, .14) screw(-3.4, .90, 2.75, .25, 160) screw(-.9, .90, 3.35, .2, 20)

-- the balance: a rim with screws of gold, two arms, and the hairspring; its cock carries a jewel
local bx, bz, by = 2.35, 1.15, .26
local balance = gr.node 'balance'
balance:add_child(gr.difference(gr.cylinder{material = brass, from = {0, -.09, 0}, to = {0, .09, 0}, radius = 1.62, edge = .025},
    gr.cylinder{material = brass, from = {0, -1, 0}, to = {0, 1, 0}, radius = 1.42}))
for k = 0, 17 do
    local a = 2 * math.pi * k / 18 + .1
    local c, s = math.cos(a), math.sin(a)
    balance:add_child(gr.cylinder{material = gold, from = {1.58 * c, 0, 1.58 * s}, to = {1.76 * c, 0, 1.76 * s}, radius = .07, edge = .015})
end
balance:add_child(gr.box{material = brass, min = {-1.5, -.05, -.11}, max = {1.5, .05, .11}, edge = .02}:rotate('y', 25))
scene:add_child(balance:rotate('y', swing):translate(bx, by, bz))
scene:add_child(gr.cylinder{material = polished, from = {bx, by - .3, bz}, to = {bx, by + .8, bz}, radius = .07})
local spiral = {}
for k = 0, 260 do local a, r = k * .26 - math.rad(swing) * (1 - k / 260), .16 + .0037 * k spiral[k + 1] = {bx + r * math.cos(a), by + .3, bz + r * math.sin(a)} end
scene:add_child(gr.sweep(blued, spiral, .016))
bridge({{2.05, .85}, {2.4, .68}, {2.75, .9}, {3.3, .45}, {4.6, -.6}, {5.2, -.9}, {5.8, -.4}, {5.5, .4}, {4.4, .7}, {3.2, 1.1}, {2.75, 1.45}, {2.35, 1.6}, {2.0, 1.35}}, .82, 1.06)
jewel(bx, 1.06, bz, .17) screw(5.0, 1.06, -.15, .25, 60)
scene:add_child(gr.cylinder{material = nickel, from = {5.0, -.1, -.15}, to = {5.0, .83, -.15}, radius = .5})
screw(4.9, .0, 3.9, .22, 15) screw(3.6, .0, -3.6, .22, 75) jewel(4.4, .03, -2.4, .16)

gr.render{node = scene, file = 'movement.png', width = 1600, height = 1000, eye = {4.6, 6.6, 8.4}, target = {.35, .35, .15}, fov = 31, aperture = .10, focus_point = {1.9, 1, 1.4}, blades = 8,
    integrator = 'path', denoise = true, tone = 'filmic', exposure = -.35, clamp = 12, max_depth = 8, background = {.012, .014, .018}, vignette = .2,
    lights = {gr.area_light{corner = {-8, 7.5, -6}, v1 = {13, 0, 0}, v2 = {0, 1.4, 2.2}, emission = {9, 8.2, 7}, visible = true},
        gr.area_light{corner = {7.5, 4, -4}, v1 = {0, 0, 8}, v2 = {1, 1.5, 0}, emission = {4, 5, 7}, visible = true},
        gr.area_light{corner = {-9, 5, 2}, v1 = {0, 0, 5}, v2 = {0, 2, 0}, emission = {3, 2.6, 2.0}, visible = true}, gr.sky_light{sky = {.05, .055, .065}}}}
