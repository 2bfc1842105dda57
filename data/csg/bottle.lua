-- TITLE: Glass: a bottle and a tumbler, merged, hollowed and filled
-- OPTIONS: -refract-limit 8 -reflect-limit 2 --cutoff 0.03
-- Glass needs merge: body, neck and lip of the bottle are one piece of glass without walls between them. The
-- liquid is cut from the shape of its hollow, slightly enlarged, so that glass and liquid touch.

local function glass(tint)
    return gr.difresnel_material(gr.rr_material {kd = {0, 0, 0}, ks = {0.97, 0.98, 0.97}, shininess = 300, reflect = 0, refract = 1, ior = 1.5, absorption = tint})
end
local function liquid(ior, tint)
    return gr.difresnel_material(gr.rr_material {kd = {0, 0, 0}, ks = {0.98, 0.98, 0.98}, shininess = 300, reflect = 0, refract = 1, ior = ior, absorption = tint})
end
local green, clear = glass {0.9, 0.25, 0.8}, glass {0.10, 0.04, 0.06}
local wine, water = liquid(1.35, {0.25, 1.6, 1.3}), liquid(1.33, {0.12, 0.03, 0.02})
local table_top = gr.wood_pnd_material(gr.rr_material({0.62, 0.40, 0.22}, {0.2, 0.2, 0.2}, 40, 0.08, 0, 1), 0.9, 8, 1, {0.40, 0.23, 0.11})
local wall = gr.material({0.72, 0.70, 0.64}, {0, 0, 0}, 1)
local stripe = gr.material({0.25, 0.42, 0.50}, {0, 0, 0}, 1)
local peel = gr.material({0.92, 0.76, 0.12}, {0.25, 0.25, 0.2}, 25)
local cork = gr.wood_pnd_material(gr.material({0.66, 0.48, 0.30}, {0, 0, 0}, 1), 9, 6, 1, {0.45, 0.30, 0.17})

-- --- the bottle, with axis y ---

local function turned(points) return gr.lathe {points = points, spline = 'catmull-rom', open = false} end
local body = gr.cylinder {from = {0, 0, 0}, to = {0, 2.6, 0}, radius = 0.62}
local shoulder = turned {{0.62, 2.55}, {0.60, 2.75}, {0.42, 3.05}, {0.24, 3.30}, {0.21, 3.55}}
local neck = gr.cylinder {from = {0, 3.5, 0}, to = {0, 4.5, 0}, radius = 0.21}
local lip = gr.torus {major = 0.2, minor = 0.07}:translate(0, 4.42, 0)
local punt = gr.cone {from = {0, -0.01, 0}, from_radius = 0.4, to = {0, 0.28, 0}, radius = 0.05}
local outside = gr.difference('outside', gr.merge('bottle', body, shoulder, neck, lip), punt)

local function hollow(grown)
    local r, s = 0.55 + grown, 0.14 + grown
    return gr.merge('hollow',
        gr.difference(gr.cylinder {from = {0, 0.12 - grown, 0}, to = {0, 2.6, 0}, radius = r},
            gr.cone {from = {0, 0.05, 0}, from_radius = 0.47 - grown, to = {0, 0.38 - grown, 0}, radius = 0.06}),
        turned {{r, 2.55}, {r - 0.02, 2.72}, {r - 0.20, 3.02}, {s + 0.04, 3.28}, {s, 3.55}},
        gr.cylinder {from = {0, 3.5, 0}, to = {0, 4.8, 0}, radius = s})
end
local bottle = gr.node('bottle')
bottle:add_child(gr.difference('glass', outside, hollow(0)):set_material(green))
bottle:add_child(gr.intersection('wine', hollow(0.01), gr.plane {normal = {0, 1, 0}, distance = 2.3}):set_material(wine))
bottle:add_child(gr.intersection('cork', gr.cone {from = {0, 3.9, 0}, from_radius = 0.138, to = {0, 4.75, 0}, radius = 0.15},
    gr.inverse(gr.sphere {centre = {0, 5.27, 0}, radius = 0.55})):set_material(cork))

-- --- the tumbler: eight flat sides cut from a cone ---

local sides = {gr.cone {from = {0, 0, 0}, from_radius = 0.46, to = {0, 1.5, 0}, radius = 0.62}}
for k = 0, 7 do
    local a = k * math.pi / 4
    sides[#sides + 1] = gr.plane {normal = {math.cos(a), -0.1, math.sin(a)}, distance = 0.435}
end
local function inner(grown)
    return gr.cone {from = {0, 0.16 - grown, 0}, from_radius = 0.36 + grown, to = {0, 1.6, 0}, radius = 0.52 + grown}
end
local tumbler = gr.node('tumbler')
tumbler:add_child(gr.difference('glass', gr.merge('rim', gr.intersection(table.unpack(sides)), gr.difference(
    gr.cone {from = {0, 1.0, 0}, from_radius = 0.46, to = {0, 1.5, 0}, radius = 0.585}, gr.plane {normal = {0, 1, 0}, distance = 1.1})), inner(0)):set_material(clear))
tumbler:add_child(gr.intersection('water', inner(0.008), gr.plane {normal = {0, 1, 0}, distance = 0.95}):set_material(water))

-- --- a lemon and a slice of it ---

local function lemon(m) return gr.merge('lemon', gr.ellipsoid {radii = {0.46, 0.36, 0.36}}, gr.cone {from = {0.3, 0, 0}, from_radius = 0.2, to = {0.56, 0, 0}, radius = 0.05}):set_material(m) end
local flesh = gr.material({0.95, 0.88, 0.45}, {0.3, 0.3, 0.2}, 40)
local pith = gr.material({0.96, 0.93, 0.80}, {0, 0, 0}, 1)
local cut = gr.intersection('half', lemon(peel), gr.plane {normal = {1, 0, 0}, distance = 0.05, material = pith})
local wedges = {}
for k = 0, 7 do
    local a, b = (k + 0.12) * math.pi / 4, (k + 0.88) * math.pi / 4
    wedges[k + 1] = gr.prism {outline = {{0.06 * math.cos((a + b) / 2), 0.06 * math.sin((a + b) / 2)}, {0.30 * math.cos(a), 0.30 * math.sin(a)},
        {0.31 * math.cos((a + b) / 2), 0.31 * math.sin((a + b) / 2)}, {0.30 * math.cos(b), 0.30 * math.sin(b)}}, from = 0.035, to = 0.2}:rotate('z', -90)
end
local half = gr.difference('open lemon', cut, gr.union('wedges', table.unpack(wedges)):set_material(flesh))

local air = 0.001 -- below the glasses: without a gap the table would be seen in them
local scene = gr.node('still life')
scene:add_child(bottle:translate(-0.75, air, -0.5))
scene:add_child(tumbler:translate(0.75, air, 0.25))
scene:add_child(lemon(peel):rotate('y', 35):translate(1.75, 0.36, -0.9))
scene:add_child(half:rotate('z', 55):rotate('y', -60):translate(-0.15, 0.30, 1.15))
scene:add_child(gr.box {min = {-6, -0.3, -2.6}, max = {6, 0, 4}, material = table_top})
scene:add_child(gr.box {min = {-14, -4, -6.2}, max = {14, 12, -6}, material = wall})
for k = -6, 6 do
    scene:add_child(gr.box {min = {1.3 * k, -4, -6}, max = {1.3 * k + 0.45, 12, -5.97}, material = stripe})
end
gr.render {
    node = scene, file = 'bottle.png', width = 300, height = 375, eye = {0.4, 2.7, 8.5}, target = {0.15, 2.1, 0}, fov = 36,
    ambient = {0.42, 0.42, 0.44}, background = {0.75, 0.80, 0.85},
    lights = {gr.area_light({-6, 7, 3}, {2, 0, 0}, {0, 1, 2}, {0.62, 0.60, 0.54}, {1, 0, 0}), gr.light({5, 5, 7}, {0.28, 0.29, 0.32}, {1, 0, 0}),
        gr.light({0, 5, -4}, {0.2, 0.2, 0.22}, {1, 0, 0})},
}
