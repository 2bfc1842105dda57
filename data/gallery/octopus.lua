-- TITLE: An octopus at rest
-- OPTIONS: --size 400x300 --spp 2
-- LARGE: --spp 32
-- The skin scatters light below its surface: arms glow where the lamp is behind them. The animal is one union of sweeps and a
-- smooth head, so light walks from arm to arm; suckers, eyes, sand and corals are around it. -D seed=3 makes another one.
-- With --frames 96 --loop it moves its arms.
-- LOOP: --frames 96 --fps 24 --loop --size 640x480 --spp 12
local sdf, random = require 'sdf', require 'random'
seed = seed or 1
local dice = random.new(seed)
local phase = 2 * math.pi * (gr.clock or 0)
local scene = gr.node 'reef'

-- skin: dark spots with pale rims over orange, paler below; wet
local function spots(p)
    local near, second, id = gr.cells(p * 5.5)
    local small = gr.cells(p * 19)
    return gr.smoothstep(.44, .30, near) * (.55 + .45 * id), gr.smoothstep(.42, .25, small)
end
local skin = gr.openpbr_material{subsurface_weight = .85, subsurface_radius = .08, subsurface_radius_scale = {1, .38, .22},
    specular_roughness = .32, coat_weight = .55, coat_roughness = .12,
    subsurface_color = function(p)
        local big, small = spots(p)
        local base = gr.mix(gr.vec(.80, .19, .07), gr.vec(.90, .55, .36), gr.smoothstep(-.55, -.95, p.y))
        return gr.mix(gr.mix(base, gr.vec(.34, .02, .02), big), gr.vec(.95, .66, .40), .35 * small * (1 - big))
    end,
    base_color = function(p) local big = spots(p) return gr.mix(gr.vec(.75, .24, .10), gr.vec(.30, .03, .03), big) end,
    geometry_normal = gr.bump(function(p) return .7 * gr.noise(p * 11) + .4 * gr.noise(p * 26) end, .008)}
local pale = gr.openpbr_material{subsurface_weight = .8, subsurface_color = {.95, .72, .55}, subsurface_radius = .06, specular_roughness = .3, coat_weight = .4}

-- the head: mantle, brow and the web between the arms
local head = sdf.smooth_union(.30, sdf.translate(sdf.rotate(sdf.ellipsoid{.62, .84, .66}, 'x', -24), {0, .62, -.34}), sdf.ellipsoid{.50, .46, .46},
    sdf.translate(sdf.sphere(.17), {.33, .27, .27}), sdf.translate(sdf.sphere(.17), {-.33, .27, .27}), sdf.translate(sdf.ellipsoid{.60, .24, .60}, {0, -.46, 0}))
local parts = {gr.implicit{material = skin, f = head, bounds = {{-1.2, -.75, -1.5}, {1.2, 1.7, 1.2}}}}

local function ground(x, z)
    return -1.02 + .025 * math.sin(2.9 * z + 3.6 * gr.noise(x * .5, 0, z * .5)) + .08 * gr.noise(x * .6, 1, z * .6) + .01 * gr.noise(x * 9, 2, z * 9)
end

-- arms: out, down to the sand, along it, and up into a curl; two rows of suckers below
local function arm(a, length, bend, curl)
    local points, radii = {}, {}
    local x, y, z, heading = .34 * math.cos(a), -.34, .34 * math.sin(a), a
    local rise = -.55
    for k = 0, 22 do
        local t = k / 22
        local r = .185 * (1 - t) ^ 1.05 + .010
        points[k + 1], radii[k + 1] = {x, math.max(y, ground(x, z) + .8 * r), z}, r
        local step = length / 22
        heading = heading + bend * step * (.4 + 1.6 * t) + .10 * math.sin(phase + 5 * t + 3 * a)
        if t > .5 then heading = heading + curl * (t - .5) * 1.15 end
        rise = -.95 + .95 * gr.smoothstep(.2, .42, t) + (.10 + .25 * math.sin(phase + a)) * gr.smoothstep(.5, .75, t)
        x, z, y = x + step * math.cos(heading), z + step * math.sin(heading), y + step * rise
    end
    parts[#parts + 1] = gr.sweep(skin, points, radii)
    for k = 5, 21 do
        local p, q, r = points[k], points[k + 1], radii[k]
        local dx, dz = q[1] - p[1], q[3] - p[3]
        local d = (dx * dx + dz * dz) ^ .5 + 1e-9
        local sx, sz = -dz / d, dx / d
        local side = curl > 0 and 1 or -1
        for row = -1, 1, 2 do
            local up = math.rad(-34 + 22 * row)
            local out, cy = .93 * r * math.cos(up) * side, p[2] + .93 * r * math.sin(up)
            scene:add_child(gr.torus(pale, .21 * r + .003, .10 * r + .003):rotate('x', 90 - math.deg(up)):rotate('y', math.deg(math.atan(sx * side, sz * side)))
                :translate(p[1] + sx * out + .25 * row * dx, cy, p[3] + sz * out + .25 * row * dz))
        end
    end
end
for i = 0, 7 do
    local a = 2 * math.pi * (i + .5) / 8 + dice:range(-.12, .12)
    arm(a, dice:range(2.2, 2.8), dice:range(-.4, .4), (i % 2 == 0 and 1 or -1) * dice:range(1.0, 1.5))
end
scene:add_child(gr.union(parts))

-- eyes: gold with a slit
local eye = gr.openpbr_material{specular_roughness = .04, coat_weight = 1, base_color = function(p)
    local slit = gr.smoothstep(1, .85, gr.length(gr.vec(p.x / .105, p.y / .034, 0)))
    local iris = gr.mix(gr.vec(.75, .48, .10), gr.vec(.35, .12, .02), gr.turbulence(p * 14, 3))
    return gr.mix(gr.mix(iris, gr.vec(.04, .02, .015), gr.smoothstep(.115, .15, gr.length(gr.vec(p.x, p.y, 0)))), gr.vec(.004, .004, .006), slit)
end}
for s = -1, 1, 2 do
    scene:add_child(gr.sphere{material = eye, radius = .165}:rotate('y', 26 * s):rotate('x', -4):translate(.37 * s, .31, .33))
    scene:add_child(gr.torus(skin, .155, .04):rotate('x', 90):rotate('x', -8):rotate('y', 30 * s):translate(.385 * s, .315, .36))
end

-- sand, pebbles, corals, rising bubbles
local sand = gr.openpbr_material{specular_roughness = .7, specular_weight = .3, base_color = function(p)
    return gr.mix(gr.vec(.42, .34, .22), gr.vec(.20, .15, .10), gr.clamp(.5 + .5 * gr.noise(p * 260) + .3 * gr.noise(p * 60), 0, 1)) end}
scene:add_child(gr.height_field{material = sand, columns = 700, smooth = true, open = true, f = function(p)
    return ground(p.x * 16 - 8, p.z * 16 - 12) / 16
end}:translate(-.5, 0, -.75):scale(16, 16, 16))
local function coral(x, z, size, colour)
    local material = gr.openpbr_material{base_color = colour, specular_roughness = .5, subsurface_weight = .3, subsurface_color = colour, subsurface_radius = .03}
    local function branch(p, before, d, r, depth)      -- it begins along the one before
        local q = p + d * (r * 7)
        scene:add_child(gr.sweep(material, {p, p + before * (r * 1.8), p + (before + 2 * d) * (r * 1.6) + gr.vec(dice:range(-.3, .3), 0, dice:range(-.3, .3)) * r, q}, {r, r * .92, r * .82, r * .75}))
        if depth > 0 then
            for _ = 1, 2 + (dice:chance(.4) and 1 or 0) do branch(q, d, (d + gr.vec(dice:range(-.9, .9), dice:range(.1, .5), dice:range(-.9, .9))):normalize(), r * .72, depth - 1) end
        end
    end
    for _ = 1, 3 do branch(gr.vec(x + dice:range(-.2, .2) * size, -1.1, z + dice:range(-.2, .2) * size), gr.vec(0, 1, 0), gr.vec(dice:range(-.5, .5), 1, dice:range(-.5, .5)):normalize(), .075 * size, 4) end
end
coral(-2.2, -2.6, 1.5, {.75, .12, .20}) coral(2.4, -3.2, 1.7, {.80, .38, .08}) coral(.4, -4.6, 1.5, {.45, .18, .55}) coral(-4.2, -5.2, 2, {.8, .45, .15}) coral(4.6, -6, 2, {.7, .12, .25})
for _ = 1, 110 do
    local x, z = dice:range(-3.6, 3.6), dice:range(-4, 2.6)
    local r = dice:range(.02, .09)
    scene:add_child(gr.ellipsoid{material = sand, centre = {x, ground(x, z) + .25 * r, z}, radii = {r * dice:range(.8, 1.4), r * .7, r}})
end
local air = gr.openpbr_material{transmission_weight = 1, specular_roughness = 0, specular_ior = 1 / 1.33}
for k = 1, 26 do
    local t = dice:range(0, 1)
    scene:add_child(gr.sphere{material = air, centre = {.95 + .16 * math.sin(9 * t) + dice:range(-.1, .1), -.6 + 3.4 * t, -.9 + dice:range(-.15, .15)}, radius = dice:range(.014, .05)})
end
local deep = gr.sky_gradient{{-1, .004, .012, .018}, {0, .012, .055, .075}, {.5, .03, .13, .16}, {1, .10, .34, .36}}
gr.render{node = scene, file = 'octopus.png', width = 1600, height = 1200, eye = {.45, 1.05, 7.0}, target = {.1, .1, 0}, fov = 28, aperture = .035, focus_point = {0, .3, .5}, background = deep,
    integrator = 'path', denoise = true, tone = 'filmic', exposure = .45, clamp = 8, max_depth = 8, vignette = .25,
    fog = gr.uniform_fog{density = .036, colour = {.012, .075, .095}},
    lights = {gr.disc_light{position = {-2.2, 5, -2.6}, normal = {.42, -1, .5}, radius = .9, emission = {34, 32, 25}},
        gr.disc_light{position = {3.4, 3.2, 4}, normal = {-.7, -.6, -.8}, radius = 1.2, emission = {2.6, 2.8, 2.6}}, gr.sky_light{sky = deep}}}
