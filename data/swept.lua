-- TITLE: Swept solids: turned, pressed and bent
-- Shapes made of many parts: lathe, prism, sphere sweep, height field, blob, hair and patches, some of them carved.
-- OPTIONS: --spp 6

local patterns = require 'patterns'
local function ceramic(r, g, b)
    return gr.openpbr_material {base_color = {r, g, b}, coat_weight = 1, coat_roughness = 0.05, specular_roughness = 0.4}
end

local scene = gr.node('scene')
local sin, cos, pi = math.sin, math.cos, math.pi

-- A small generator of its own, so that the picture is the same everywhere.
local seed = 7
local function random(low, high)
    seed = (seed * 16807) % 2147483647
    return low + (high - low) * seed / 2147483647
end

-- The table top: a lathe with a rounded rim.
scene:add_child(gr.lathe {
    name = 'table', spline = 'b-spline',
    material = gr.openpbr_material {coat_weight = 0.3, coat_roughness = 0.2, specular_roughness = 0.4, base_color = function(p)
        local grain = patterns.wood(gr.vec(p.y * 0.4 + 2.3, p.z * 0.6 + 0.4, p.x * 0.08))
        return gr.mix(gr.vec(0.27, 0.135, 0.058), gr.vec(0.19, 0.088, 0.036), grain) * (0.85 + 0.35 * gr.noise(p.x * 1.2, 0, p.z * 22))
    end},
    points = {{0, -0.5}, {8, -0.5}, {8.6, -0.45}, {8.7, -0.2}, {8.5, 0}, {8, 0}, {0, 0}},
})

-- Mountains behind it: a height field from sums of waves.
local heights = {}
for j = 0, 160 do
    local row = {}
    for i = 0, 160 do
        local x, z, h, f, a = i / 160, j / 160, 0, 3, 0.5
        for octave = 1, 6 do
            local ridge = math.abs(sin(f * x * 2.3 + octave * 1.7 + cos(f * z)))
            h = h + a * ridge * math.abs(cos(f * z * 1.9 + octave + sin(f * x * 0.7)))
            f, a = f * 2.03, a * 0.47
        end
        row[i + 1] = h * (1 - (2 * x - 1) ^ 4) * (1 - (2 * z - 1) ^ 4)
    end
    heights[j + 1] = row
end
local land = gr.height_field {
    name = 'mountains', heights = heights, floor = -0.2, smooth = true,
    material = gr.openpbr_material {specular_weight = 0, base_color = function(p, s) -- snow lies where it is not too steep
        local q = gr.vec(56 * p.x, 11 * p.y, 24 * p.z)
        local snow = gr.smoothstep(0.62, 0.78, s.normal.y + 0.14 * gr.noise(q * 1.3) + 0.10 * gr.noise(q * 4) + 0.25 * (p.y - 0.45))
        return gr.mix(gr.vec(0.15, 0.14, 0.15) * (0.6 + 0.8 * gr.turbulence(q * 0.9, 4)), gr.vec(0.62, 0.67, 0.75), snow)
    end},
}
land:translate(-0.5, 0, -0.5):scale(56, 11, 24):translate(0, -4.2, -26)
scene:add_child(land)

-- A vase of a spline profile with a wall, cut open to show it; the cut face has the material of the cutter.
local profile = {{0, 0}, {0.75, 0}, {0.85, 0.12}, {1.15, 0.9}, {1.05, 1.7}, {0.5, 2.4}, {0.45, 2.75}, {0.72, 3.1},
    {0.62, 3.1}, {0.36, 2.75}, {0.40, 2.4}, {0.92, 1.7}, {1.02, 0.95}, {0.72, 0.25}, {0, 0.18}}
local cut = gr.difference('cut vase',
    gr.lathe {name = 'vase', points = profile, spline = 'catmull-rom', material = ceramic(0.02, 0.08, 0.36)},
    gr.box {min = {0, -1, 0}, max = {3, 5, 3}, material = gr.openpbr_material {base_color = {0.62, 0.30, 0.16}, specular_weight = 0.2}})
cut:rotate('y', -38):translate(-3.6, 0, 0.4)
scene:add_child(cut)

-- Grass in another one: hairs along splines, thinner to the tip.
local pot = gr.node('pot')
pot:add_child(gr.lathe {
    name = 'bowl', spline = 'catmull-rom', material = ceramic(0.78, 0.76, 0.70),
    points = {{0, 0}, {0.8, 0}, {1.2, 0.5}, {1.15, 1.0}, {1.05, 1.0}, {1.0, 0.8}, {0, 0.7}},
})
local greens = {
    gr.openpbr_material {base_color = {0.06, 0.17, 0.02}, specular_roughness = 0.5}, gr.openpbr_material {base_color = {0.12, 0.25, 0.03}, specular_roughness = 0.5},
    gr.openpbr_material {base_color = {0.24, 0.29, 0.05}, specular_roughness = 0.5},
}
for k = 1, 700 do
    local angle, r = random(0, 2 * pi), 0.95 * math.sqrt(random(0, 1))
    local lean, tall, turn = random(0.1, 0.9) * (0.3 + r), random(1.2, 2.4), angle + random(-0.8, 0.8)
    local x, z = r * cos(angle), r * sin(angle)
    pot:add_child(gr.curve {
        name = 'blade', spline = 'bezier', material = greens[k % 3 + 1], widths = {0.05, 0.045, 0.035, 0.004},
        points = {{x, 0.7, z}, {x + 0.1 * cos(turn), 0.7 + tall * 0.4, z + 0.1 * sin(turn)},
            {x + 0.4 * lean * cos(turn), 0.7 + tall * 0.9, z + 0.4 * lean * sin(turn)},
            {x + 1.3 * lean * cos(turn), 0.7 + tall * (1 - 0.3 * lean), z + 1.3 * lean * sin(turn)}},
    })
end
pot:translate(-0.9, 0, -2.6)
scene:add_child(pot)

-- A trefoil knot: a ball along a closed spline.
local knot = {}
for k = 0, 35 do
    local t = 2 * pi * k / 36
    knot[k + 1] = {sin(t) + 2 * sin(2 * t), -sin(3 * t), cos(t) - 2 * cos(2 * t)}
end
local gold = gr.metal_material {metal = 'gold', roughness = 0.12}
scene:add_child(gr.sweep {name = 'knot', points = knot, radii = 0.42, loop = true, material = gold}
    :rotate('x', 90):scale(0.5, 0.5, 0.5):rotate('y', 20):translate(2.1, 1.62, -1.6))

-- A snake whose radius changes.
local path, radii = {}, {}
for k = 0, 16 do
    radii[k + 1] = k == 0 and 0.10 or k == 1 and 0.17 or 0.15 * (1 - k / 17) + 0.02
    path[k + 1] = {k * 0.26, radii[k + 1], 0.35 * sin(k * 0.9) * (1 - k / 40)}
end
scene:add_child(gr.sweep {name = 'snake', points = path, radii = radii, material = ceramic(0.02, 0.16, 0.06)}
    :rotate('y', 8):translate(-2.1, 0, 3.3))

-- A gear: a prism with teeth of splines and holes, carved on top by a lathe.
local teeth, holes = {}, {}
for k = 0, 47 do
    local r = k % 4 < 2 and 1.25 or 1.0
    teeth[k + 1] = {r * cos(k * pi / 24), r * sin(k * pi / 24)}
end
for h = 0, 5 do
    local hole = {}
    for k = 0, 7 do
        local around, about = h * pi / 3, k * pi / 4
        hole[k + 1] = {0.66 * cos(around) + 0.17 * cos(about), 0.66 * sin(around) + 0.17 * sin(about)}
    end
    holes[h + 1] = hole
end
local steel = gr.metal_material {metal = 'iron', roughness = function(p) return 0.25 + 0.1 * gr.turbulence(p * 4, 3) end}
local gear = gr.difference('gear',
    gr.prism {outline = teeth, holes = holes, to = 0.4, spline = 'catmull-rom', material = steel},
    gr.lathe {points = {{0.2, -1}, {0.2, 0.3}, {0.36, 0.3}, {0.36, 1}}, material = steel})
gear:rotate('y', 14):rotate('x', 62):translate(4.7, 1.16, -0.2)
scene:add_child(gear)

-- A blob: the crown of a drop in a liquid, of rods and balls; the last ball is subtracted.
local balls, rods = {}, {}
for k = 0, 11 do
    local a, b, tall = k * pi / 6, (k + 1) * pi / 6, 0.85 + 0.2 * sin(k * 2.4)
    rods[#rods + 1] = {cos(a), 0.12, sin(a), cos(b), 0.12, sin(b), 0.38}
    rods[#rods + 1] = {cos(a), 0.1, sin(a), 1.25 * cos(a), tall, 1.25 * sin(a), 0.30, 0.8}
    balls[#balls + 1] = {1.34 * cos(a), tall + 0.15 + 0.35 * (k % 3), 1.34 * sin(a), 0.30, 1.2}
end
balls[#balls + 1] = {0, 0.75, 0, 0.55, 1.5}
balls[#balls + 1] = {0, 0.2, 0, 0.7, 1}
balls[#balls + 1] = {0, 0.45, 0, 0.35, -0.6}
scene:add_child(gr.blob {
    name = 'crown', threshold = 0.45, spheres = balls, cylinders = rods,
    material = ceramic(0.42, 0.012, 0.02),
}:rotate('y', 10):translate(0.3, 0.05, 1.3))

-- A patch as a dish for three cherries.
local dish = {}
for j = 0, 3 do
    for i = 0, 3 do
        local x, z = i / 1.5 - 1, j / 1.5 - 1
        local y = 0.25 + 0.55 * x * x + 0.5 * z * z + 0.35 * x * z
        dish[#dish + 1] = {1.3 * x * (1 - 0.25 * z * z), y, 1.1 * z * (1 - 0.2 * x * x)}
    end
end
scene:add_child(gr.patch {
    name = 'dish', points = dish, tolerance = 0.001, flip = true,
    material = gr.metal_material {metal = 'brass', roughness = 0.25},
}:scale(0.8, 0.8, 0.8):rotate('y', 30):translate(3.3, -0.42, 3.4))
for k = 0, 2 do
    scene:add_child(gr.sphere {name = 'cherry', material = ceramic(0.30, 0.006, 0.015), radius = 0.2,
        centre = {3.3 + 0.22 * cos(k * 2.1 + 0.5), 0.36 + 0.02 * k, 3.4 + 0.22 * sin(k * 2.1 + 0.5)}})
end

local sky = gr.sky_gradient {{-1, 0.10, 0.10, 0.10}, {0, 0.66, 0.74, 0.82}, {0.25, 0.30, 0.48, 0.78}, {1, 0.12, 0.24, 0.58}}
gr.render {
    node = scene, file = 'swept.png', width = 640, height = 400, fov = 32,
    eye = {0.3, 5.2, 13.5}, target = {0.2, 1.05, 0}, up = {0, 1, 0},
    integrator = 'path', denoise = true, tone = 'filmic', exposure = -0.35, clamp = 12, max_depth = 5, background = sky,
    lights = {gr.spherical_light {position = {-34, 34, 22}, radius = 1.4, emission = {2400, 2000, 1450}}, gr.sky_light {sky = sky}},
}
