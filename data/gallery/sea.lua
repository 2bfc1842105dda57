-- TITLE: A buoy at sunset
-- OPTIONS: --size 400x250 --spp 12
-- LARGE: --spp 80
-- A low sun draws its road over the swell. The water is a height field of Gerstner-like waves and ripples; foam lies on the
-- crests; the buoy has rust, a cage, a lamp, and a gull. With --frames 72 --loop the waves pass.
-- LOOP: --frames 72 --fps 24 --loop --size 800x500 --spp 12
local random = require 'random'
local scene = gr.node 'sea'
local dice = random.new(3)
local clock = gr.clock or 0                       -- a loop of three seconds
local cells = quick and 200 or 1500               -- -D quick=true makes a draft
local sun = gr.vec(.16, .075, -1):normalize()

-- waves: a sum of crests along directions near that of the wind; the sharper ones are shorter
local waves = {}
for k = 1, 26 do
    local length = 9 * .80 ^ k + .16
    local angle = math.rad(68 + dice:range(-38, 38))
    local passing = math.floor(5 / length ^ .5 + .5)   -- crests in a loop: the speed of deep water
    waves[k] = {math.cos(angle) / length, math.sin(angle) / length, .0078 * length ^ 1.02, dice:range(0, 1) - passing * clock}
end
local function height(x, z)
    local h = 0
    for k, w in ipairs(waves) do
        local s = .5 + .5 * gr.noise(x * .11 + 7 * k, 0, z * .11)
        h = h + w[3] * 2.4 * s * (1 - 2 * math.abs(math.sin(math.pi * (w[1] * x + w[2] * z + w[4] + .25 * gr.noise(x * .6, k, z * .6)))) ^ 1.25)
    end
    return h + .006 * gr.noise(x * 7, 1, z * 7)
end
local function water(size)                         -- ripples that are finer than the cells of the field are a bump map
    return gr.openpbr_material{base_color = {.008, .034, .036}, specular_roughness = .05, specular_ior = 1.333,
        geometry_normal = gr.bump(function(p) local q = p * size + gr.vec(0, .1 * math.sin(2 * math.pi * clock), .1 - .1 * math.cos(2 * math.pi * clock)) return (gr.noise(q * 5) + .5 * gr.noise(q * 12)) / size end, .017)}
end
local function field(size, middle, columns, sink)
    scene:add_child(gr.height_field{material = water(size), columns = columns, smooth = true, open = true,
        f = function(p) return (height((p.x - .5) * size, p.z * size - middle) - sink) / size end}:scale(size, size, size):translate(-size / 2, 0, -middle))
end
field(26, 19, cells, 0)
field(220, 238, cells, .02)
field(1900, 2120, cells, .04)                     -- to the horizon
scene:add_child(gr.plane{material = water(1), normal = {0, 1, 0}, distance = -.35})

-- the buoy
local red = gr.openpbr_material{specular_roughness = .35, coat_weight = .25, base_color = function(p)
    local rust = gr.smoothstep(.35, .6, gr.turbulence(p * 2.4, 4) + .35 * gr.smoothstep(.4, -.1, p.y))
    local drip = gr.smoothstep(.15, .5, gr.noise(p.x * 9, p.y * .9, p.z * 9)) * gr.smoothstep(.9, .2, p.y)
    return gr.mix(gr.mix(gr.vec(.52, .030, .018), gr.vec(.16, .050, .018), rust), gr.vec(.11, .045, .02), .6 * drip)
end}
local white = gr.openpbr_material{base_color = function(p) return gr.vec(.72, .69, .60) * (1 - .3 * gr.turbulence(p * 3, 3)) end, specular_roughness = .4}
local iron = gr.openpbr_material{base_color = {.05, .045, .045}, specular_roughness = .4, base_metalness = .3}
local buoy = gr.node 'buoy'
buoy:add_child(gr.lathe(red, {{0, -.7}, {.72, -.5}, {1.0, -.15}, {1.02, .16}, {1.0, .22}, {.86, .27}, {.5, .32}, {0, .34}}))
buoy:add_child(gr.torus(white, 1.0, .07):translate(0, .12, 0))
buoy:add_child(gr.cone{material = red, from = {0, .3, 0}, to = {0, 1.35, 0}, from_radius = .42, radius = .26})
buoy:add_child(gr.cone{material = white, from = {0, .70, 0}, to = {0, .98, 0}, from_radius = .3475, radius = .305})
buoy:add_child(gr.cylinder{material = iron, from = {0, 1.35, 0}, to = {0, 1.40, 0}, radius = .44, edge = .015})
for k = 0, 7 do
    local a = 2 * math.pi * k / 8
    local c, s = math.cos(a), math.sin(a)
    buoy:add_child(gr.cylinder{material = iron, from = {.40 * c, 1.4, .40 * s}, to = {.40 * c, 1.66, .40 * s}, radius = .014})
    if k % 2 == 0 then buoy:add_child(gr.cylinder{material = iron, from = {.17 * c, 1.4, .17 * s}, to = {.17 * c, 1.80, .17 * s}, radius = .014}) end
    if k % 4 == 1 then buoy:add_child(gr.torus(iron, .10, .022):rotate('x', 90):rotate('y', 45 * k):translate(.98 * c, .30, .98 * s)) end
end
buoy:add_child(gr.torus(iron, .40, .016):translate(0, 1.66, 0))
buoy:add_child(gr.sphere{material = gr.material{kd = {0, 0, 0}, emission = {3.4, 1.25, .32}}, centre = {0, 1.60, 0}, radius = .11})
buoy:add_child(gr.cone{material = iron, from = {0, 1.95, 0}, to = {0, 1.78, 0}, radius = .23})
scene:add_child(buoy:rotate('z', 11 + 3 * math.sin(2 * math.pi * clock)):rotate('x', -7 + 2 * math.sin(4 * math.pi * clock)):translate(-1.75, height(-1.75, -4) - .20, -4))

-- gulls
local feathers = gr.openpbr_material{base_color = {.35, .33, .33}, specular_weight = .1}
local function gull(x, y, z, size, flap, turn)
    flap = flap + (.25 - flap + .55) * math.sin(math.pi * clock * (7 + turn % 3)) ^ 2   -- wing beats of a loop
    local bird = gr.node 'gull'
    bird:add_child(gr.sweep(feathers, {{0, .02, -.62}, {0, .02, -.40}, {0, .01, -.12}, {0, .01, .16}, {0, .06, .40}, {0, .075, .52}, {0, .05, .62}, {0, .035, .72}}, {.05, .035, .105, .125, .075, .072, .03, .008}))
    for side = -1, 1, 2 do
        bird:add_child(gr.sweep(feathers, {{0, .05, .12}, {side * .40, .05 + .42 * flap, .20}, {side * .85, .05 + .46 * flap, .08}, {side * 1.55, .05 + .26 * flap, -.28}}, {.085, .07, .05, .004}))
    end
    scene:add_child(bird:scale(size, size, size):rotate('z', 12):rotate('y', turn):translate(x, y, z))
end
gull(1.15, 2.55, -7, .40, .75, 55) gull(2.75, 3.35, -11, .40, .55, 34) gull(-.1, 3.3, -14, .42, .9, 24)

-- the sky: a glow around the sun, its disc, and thin clouds that are lit from below
local function dome(d)
    local up, toward = gr.max(d.y, 0), gr.clamp(d:dot(sun), 0, 1)
    local air = gr.mix(gr.vec(1.0, .42, .11), gr.mix(gr.vec(.62, .34, .20), gr.vec(.12, .15, .24), gr.smoothstep(.12, .65, up)), gr.smoothstep(-.02, .22, up))
    air = air * (.35 + .65 * toward ^ 3) + gr.vec(1.9, .85, .24) * (.55 * toward ^ 60 + 1.3 * toward ^ 900)
    local q = gr.vec(d.x, 0, d.z) / (up + .09)
    local veil = gr.noise(q.x * .35, 2, q.z * 1.1) + .5 * gr.noise(q.x * .9, 3, q.z * 2.6) + .25 * gr.noise(q.x * 2.1, 4, q.z * 5.5)
    local cloud = gr.smoothstep(-.1, .55, veil) * gr.smoothstep(.015, .10, up)
    local lit = gr.mix(gr.vec(.26, .16, .15), gr.vec(2.4, .95, .30), toward ^ 9)
    return gr.mix(air, lit, .85 * cloud) + gr.vec(40, 22, 8) * gr.smoothstep(.99989, .99997, toward)
end
local sky = gr.sky_function(dome)
gr.render{node = scene, file = 'sea.png', width = 1600, height = 1000, eye = {0, 1.25, 4.4}, target = {-.15, 1.12, -4}, fov = 33,
    integrator = 'path', denoise = true, tone = 'filmic', exposure = -.25, resolve = 'bright', clamp = 20, max_depth = 6, background = sky, bloom = .10, vignette = .15,
    lights = {gr.sky_light{sky = sky}, gr.sun_light{sun = sun, colour = {24, 11.5, 3.8}}}}
