-- TITLE: The pavilion
-- OPTIONS: --size 400x250 --spp 8
-- LARGE: --spp 64
-- A dome cut from a gyroid, lit by one lamp inside, in new snow at night. Footprints lead to it; flakes fall between the birches.
local sdf, random = require 'sdf', require 'random'
local scene = gr.node 'garden'
local dice = random.new(12)

-- the dome: a wall of 14 cm along a gyroid, in a shell of a ball, on a ring; the door has an arch
local plaster = gr.openpbr_material{specular_roughness = .55, specular_weight = .4,
    base_color = function(p) return gr.vec(.84, .81, .76) * (1 - .10 * gr.turbulence(p * 1.4, 3)) end}
local gyroid = sdf.intersection(sdf.gyroid(1.5, .15), sdf.shell(sdf.sphere(2.4), .46))
local door = sdf.union(sdf.box{.52, .86, 4}, sdf.translate(sdf.rotate(sdf.cylinder(.52, 4), 'x', 90), {0, .86, 0}))
local dome = sdf.difference(gyroid, door)
scene:add_child(gr.implicit{material = plaster, f = dome, bounds = {{-2.7, 0, -2.7}, {2.7, 2.7, 2.7}}})
scene:add_child(gr.difference(gr.cylinder{material = plaster, from = {0, -.2, 0}, to = {0, .07, 0}, radius = 2.72, edge = .02},
    gr.cylinder{material = plaster, from = {0, .0, 0}, to = {0, 1, 0}, radius = 2.05}))

-- the snow: drifts, a bank around the dome, and a track of footprints that ends at the door
local steps = {}
for k = 7, 22 do steps[k - 6] = {.1 + 1.25 * (k / 20) ^ 1.4 + (k % 2 == 0 and .10 or -.10), 1.8 + .36 * k} end
local function ground(x, z)
    local d = (x * x + z * z) ^ .5
    local h = .10 * gr.noise(x * .35, 0, z * .35) + .035 * gr.noise(x * 1.3, 3, z * 1.3) + .004 * gr.noise(x * 19, 0, z * 19)
    h = h * gr.smoothstep(2.2, 4.5, d) + .10 * gr.smoothstep(.55, 0, gr.max(d - 2.75, 2.75 - d)) * gr.smoothstep(.3, .8, gr.max(x, -x, -z))
    h = h + 2.3 * gr.smoothstep(7, 32, -z) * (.55 + .45 * gr.noise(x * .09 + 2, 5, z * .05))
    for _, s in ipairs(steps) do
        local sole, heel = ((x - s[1]) / .052) ^ 2 + ((z - s[2] + .06) / .13) ^ 2, ((x - s[1]) / .042) ^ 2 + ((z - s[2] - .12) / .075) ^ 2
        h = h - .05 * gr.smoothstep(1.5, .7, gr.min(sole, heel))
    end
    return h
end
local snow = gr.openpbr_material{base_color = {.84, .86, .90}, specular_roughness = .5, specular_weight = .4}
local near, far = 16, 80
scene:add_child(gr.height_field{material = snow, f = function(p) return ground((p.x - .5) * near, (p.z - .35) * near) / near end, columns = 1100, smooth = true, open = true}
    :translate(-.5, 0, -.35):scale(near, near, near))
scene:add_child(gr.height_field{material = snow, f = function(p) return (ground((p.x - .5) * far, (p.z - .8) * far) - .03) / far end, columns = 400, smooth = true, open = true}
    :translate(-.5, 0, -.8):scale(far, far, far))

-- birches: white trunks with dark marks, and thin branches
local bark = gr.openpbr_material{specular_roughness = .7, base_color = function(p)
    local mark = gr.smoothstep(.28, .36, gr.noise(p.x * 4, p.y * 11, p.z * 4)) + gr.smoothstep(.5, .1, p.y) * .6
    return gr.mix(gr.vec(.62, .60, .57), gr.vec(.03, .03, .03), gr.clamp(mark, 0, 1))
end}
local twig = gr.openpbr_material{base_color = {.07, .05, .05}, specular_roughness = .7}
local function birch(x, z, height, lean)
    local tree, points, radii = gr.node 'birch', {}, {}
    for k = 0, 8 do
        local t = k / 8
        points[k + 1] = {lean * t ^ 1.5 + .06 * dice:range(-1, 1) * t, height * t - .3, .08 * dice:range(-1, 1) * t}
        radii[k + 1] = .11 * (1 - t) ^ .8 + .008
    end
    tree:add_child(gr.sweep(bark, points, radii))
    -- a branch bends towards the light, its tip hangs; branches leave it on both sides
    local function grow(p, d, length, radius, depth)
        local branch, widths, sideways = {p}, {radius}, d:cross(gr.vec(0, 1, 0)):normalize()
        for k = 1, 4 do
            d = (d + gr.vec(dice:range(-.14, .14), .16 - .11 * k, dice:range(-.14, .14))):normalize()
            branch[k + 1], widths[k + 1] = branch[k] + d * (length / 4), radius * (1 - .21 * k)
            for side = -1, depth > 0 and k < 4 and 1 or -2, 2 do
                grow(branch[k + 1], (d + sideways * side * dice:range(.5, 1)):normalize(), length * dice:range(.4, .6) * (1 - .12 * k), widths[k + 1] * .7, depth - 1)
            end
        end
        tree:add_child(gr.sweep(twig, branch, widths))
    end
    for k = 0, 23 do
        local t, a = .24 + .031 * k, 2.4 * k + dice:range(-.3, .3)
        local q = t * 8 // 1 + 1
        local base = gr.mix(gr.vec(points[q]), gr.vec(points[q + 1]), t * 8 % 1)
        grow(base, gr.vec(math.cos(a), .7 + .9 * t, math.sin(a)):normalize(), (1.08 - t) * height * .32, .028 * (1.15 - t), 2)
    end
    scene:add_child(tree:translate(x, ground(x, z), z))
end
birch(-3.6, -1.2, 7.5, .3) birch(-4.5, .4, 6.6, -.5) birch(3.9, -2.0, 7.8, -.2) birch(5.2, -4.5, 8, .4) birch(-2.2, -5.5, 8, .2)
birch(-6.8, -4.5, 8, .3) birch(7.6, -7, 8.5, -.3) birch(1.6, -8.5, 8.5, .2) birch(-5.3, -9, 9, 0) birch(4.2, -11, 9, .3) birch(-9.5, -8, 9, .3) birch(10.5, -11, 9, 0)

-- someone on the way to the door: a coat, a red scarf, a cap
local wool = gr.openpbr_material{base_color = {.05, .045, .05}, fuzz_weight = .5, fuzz_color = {.3, .28, .3}, specular_weight = .1}
local scarf = gr.openpbr_material{base_color = {.55, .03, .02}, fuzz_weight = .5, specular_weight = .1}
local hair = gr.openpbr_material{base_color = {.09, .05, .03}, fuzz_weight = .3, fuzz_color = {.4, .25, .15}, specular_weight = .3}
local walker = gr.node 'walker'
local coat = sdf.smooth_union(.05, sdf.capsule({0, .30, 0}, {0, .78, -.02}, .185, .095), sdf.capsule({-.10, .815, -.02}, {.10, .815, -.02}, .055),
    sdf.capsule({.15, .80, -.02}, {.205, .48, .05}, .048, .042), sdf.capsule({-.15, .80, -.02}, {-.205, .49, -.09}, .048, .042))
walker:add_child(gr.implicit{material = wool, radius = .8, centre = {0, .5, 0}, f = sdf.union(sdf.intersection(coat, sdf.plane({0, -1, 0}, -.26)),
    sdf.capsule({.075, .05, .10}, {.07, .4, .02}, .042, .06), sdf.capsule({-.07, .05, -.15}, {-.065, .4, 0}, .042, .06),
    sdf.capsule({.075, .03, .12}, {.08, .03, .0}, .045), sdf.capsule({-.07, .03, -.13}, {-.075, .03, -.25}, .045))})
walker:add_child(gr.sphere{material = hair, centre = {0, .99, -.03}, radius = .075})
walker:add_child(gr.ellipsoid{material = wool, centre = {0, 1.03, -.015}, radii = {.085, .062, .085}})
walker:add_child(gr.torus(scarf, .065, .035):translate(0, .885, -.02))
walker:add_child(gr.sweep(scarf, {{.05, .88, .05}, {.08, .78, .12}, {.07, .66, .14}}, {.03, .032, .028}))
scene:add_child(walker:scale(1.2, 1.2, 1.2):translate(.29, ground(.29, 4.05) + .01, 4.05))

-- falling snow, none near the camera or the dome; a flake shines a little, as light goes through it
local flake = gr.openpbr_material{base_color = {.9, .92, .95}, emission_luminance = .10, emission_color = {.8, .9, 1.1}}
for _ = 1, 420 do
    local z = dice:range(-7, 5)
    local p, radius = gr.vec(dice:range(-.42, .42) * (13 - z) + .6, dice:range(.2, 4.4), z), dice:range(.010, .02)
    if p:length() > 3.1 then scene:add_child(gr.sphere{material = flake, centre = p, radius = radius}) end
end
-- the lamp on its stand
scene:add_child(gr.sphere{material = gr.material{kd = {0, 0, 0}, emission = {44, 23, 8.5}}, centre = {-.28, .92, -.2}, radius = .26})
scene:add_child(gr.lathe(twig, {{0, -.1}, {.19, -.1}, {.19, .03}, {.15, .055}, {.05, .08}, {.03, .14}, {.03, .7}, {0, .7}}):translate(-.28, 0, -.2))

-- the moon is a wide disc: its shadows are soft
local night = gr.sky_gradient{{-1, .006, .01, .022}, {0, .026, .042, .095}, {.25, .013, .024, .065}, {1, .004, .008, .03}}
gr.render{node = scene, file = 'pavilion.png', width = 1600, height = 1000, eye = {1.9, 1.25, 10.2}, target = {.12, 1.5, 0}, fov = 30,
    integrator = 'path', denoise = true, tone = 'filmic', exposure = .25, clamp = 10, max_depth = 6, background = night, bloom = .06, vignette = .25,
    aperture = .025, focus_point = {0, 1, 1.8},
    lights = {gr.sky_light{sky = night}, gr.disc_light{position = {-25.5, 23.2, 20.9}, normal = {.55, -.5, -.45}, radius = 9, emission = {.55, .83, 1.68}}}}
