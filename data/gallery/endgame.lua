-- TITLE: The end game
-- OPTIONS: --size 400x250 --spp 12
-- LARGE: --spp 96
-- Turned pieces of box and rosewood late in a game: white has a rook and two pawns, black a bishop and hope. Grain follows the
-- axis of the lathe, edges are worn pale or dark, felt is below; evening sun comes through a window with bars.
local patterns, random = require 'patterns', require 'random'
local scene = gr.node 'end game'
local dice = random.new(8)

-- wood whose trunk is along y, as a turner takes it; fingers have polished it unevenly
local function wood(light, dark, scale, seed, rough, trunk)
    return gr.openpbr_material{coat_weight = .35, coat_roughness = .12, specular_roughness = function(p) return rough + .14 * gr.turbulence(p * 2.2, 3) end,
        base_color = function(p)
            local q = trunk == 'x' and gr.vec(p.y, p.z, p.x * .25) or gr.vec(p.x, p.z, p.y * .25)
            local rings = patterns.wood(q * scale + gr.vec(1.7 + .37 * seed, .9 - .21 * seed, seed))
            local fibre = trunk == 'x' and gr.noise(p.x * 2, p.y * 40, p.z * 40) or gr.noise(p.x * 34, p.y * 2.4, p.z * 34)
            return gr.mix(light, dark, gr.clamp(.75 * rings + .10 * fibre, 0, 1)) * (.92 + .10 * gr.noise(p * 3 + gr.vec(seed, 0, 0)))
        end}
end
local box = {gr.vec(.66, .42, .18), gr.vec(.46, .25, .085)}
local rose = {gr.vec(.135, .036, .018), gr.vec(.035, .011, .008)}
local felt = gr.openpbr_material{base_color = {.03, .13, .06}, fuzz_weight = .8, fuzz_color = {.2, .5, .3}, specular_weight = 0}

-- profiles: pairs of radius and height, one square of the board is 1
local foot = {{0, .03}, {.36, .03}, {.385, .06}, {.385, .13}, {.36, .16}, {.33, .17}, {.335, .20}, {.31, .235}}
local function profile(rest)
    local points = {}
    for _, p in ipairs(foot) do points[#points + 1] = p end
    for _, p in ipairs(rest) do points[#points + 1] = p end
    return points
end
local shapes = {
    pawn = {{.22, .28}, {.155, .42}, {.125, .56}, {.12, .62}, {.20, .65}, {.215, .67}, {.20, .69}, {.12, .715}, {.165, .76}, {.195, .83}, {.19, .90}, {.15, .96}, {.08, .995}, {0, 1.005}},
    rook = {{.26, .28}, {.215, .45}, {.195, .62}, {.195, .70}, {.25, .74}, {.26, .76}, {.245, .785}, {.23, .80}, {.285, .86}, {.295, .90}, {.295, 1.08}, {.285, 1.10}, {.20, 1.10}, {.19, 1.08}, {.19, 1.0}, {0, .99}},
    bishop = {{.23, .28}, {.165, .50}, {.135, .76}, {.125, .88}, {.21, .915}, {.225, .935}, {.21, .955}, {.13, .98}, {.18, 1.05}, {.205, 1.14}, {.185, 1.24}, {.13, 1.34}, {.06, 1.41}, {.035, 1.42}, {.058, 1.45}, {.058, 1.49}, {.03, 1.52}, {0, 1.525}},
    king = {{.26, .28}, {.19, .52}, {.155, .86}, {.145, 1.06}, {.235, 1.10}, {.25, 1.12}, {.235, 1.145}, {.16, 1.165}, {.175, 1.20}, {.24, 1.44}, {.255, 1.50}, {.24, 1.53}, {.14, 1.575}, {.06, 1.60}, {.05, 1.62}, {0, 1.625}},
}
local function piece(kind, side, seed)
    local colours = side == 'white' and box or rose
    local material = wood(colours[1], colours[2], 1.6, seed, side == 'white' and .30 or .24)
    local node, body = gr.node(kind), gr.lathe(material, profile(shapes[kind]), 'catmull-rom')
    if kind == 'rook' then
        local slots = {body}
        for k = 0, 2 do slots[#slots + 1] = gr.box(material, {-.5, 1.0, -.045}, {.5, 1.3, .045}):rotate('y', 60 * k + 12) end
        body = gr.difference(slots)
    elseif kind == 'bishop' then
        body = gr.difference(body, gr.box(material, {-.3, 0, -.018}, {.3, .2, .018}):rotate('y', 20):rotate('x', -38):translate(0, 1.22, .10))
    elseif kind == 'king' then
        node:add_child(gr.box{material = material, min = {-.038, 1.60, -.032}, max = {.038, 1.86, .032}, edge = .012})
        node:add_child(gr.box{material = material, min = {-.10, 1.70, -.03}, max = {.10, 1.775, .03}, edge = .012})
    end
    node:add_child(body)
    node:add_child(gr.cylinder{material = felt, from = {0, 0, 0}, to = {0, .031, 0}, radius = .352})
    return node
end
local function at(kind, side, column, row, turn)      -- columns and rows 1 to 8
    scene:add_child(piece(kind, side, column + 9 * row):rotate('y', turn or dice:range(0, 360)):translate(column - 4.5 + dice:range(-.025, .025), 0, 4.5 - row + dice:range(-.025, .025)))
end
local function lying(kind, side, x, z, turn, lean)    -- on its side, on the table
    local r = .385
    scene:add_child(piece(kind, side, x + z):rotate('z', -90 + lean):translate(0, r - .42, 0):rotate('y', turn):translate(x, 0, z))
end

-- the board: squares with grain of their own, a frame with a line of brass
for i = 1, 8 do
    for k = 1, 8 do
        local c = (i + k) % 2 == 1 and {gr.vec(.46, .30, .14), gr.vec(.34, .20, .08)} or {gr.vec(.14, .058, .026), gr.vec(.075, .028, .014)}
        local x, z = i - 4.5, 4.5 - k
        scene:add_child(gr.box{material = wood(c[1], c[2], .8, 3 * i + 7 * k, .26, 'x'), min = {x - .4985, -.2, z - .4985}, max = {x + .4985, 0, z + .4985}, edge = .004})
    end
end
local frame = wood(gr.vec(.17, .062, .028), gr.vec(.07, .024, .012), .7, 2, .26, 'x')
for s = -1, 1, 2 do
    scene:add_child(gr.box{material = frame, min = {-4.7, -.3, s * 4.36 - .32}, max = {4.7, .012, s * 4.36 + .32}, edge = .05})
    scene:add_child(gr.box{material = frame, min = {s * 4.36 - .32, -.3, -4.69}, max = {s * 4.36 + .32, .010, 4.69}, edge = .05})
end
local cloth = gr.openpbr_material{base_color = {.030, .055, .045}, fuzz_weight = .6, fuzz_color = {.12, .22, .18}, specular_weight = .1, geometry_normal = gr.bump(function(p) return gr.noise(p * 26) end, .004)}
scene:add_child(gr.plane{material = cloth, normal = {0, 1, 0}, distance = -.42})

at('king', 'white', 3, 3, 20) at('rook', 'white', 4, 6) at('pawn', 'white', 5, 4) at('pawn', 'white', 2, 2)
at('king', 'black', 6, 6, 60) at('bishop', 'black', 5, 5, 200) at('pawn', 'black', 7, 5) at('pawn', 'black', 3, 5)
lying('pawn', 'black', -5.9, 1.3, 30, 12) lying('rook', 'black', -6.3, -.6, 100, 8) lying('pawn', 'white', 5.9, -.4, 200, 12) lying('bishop', 'white', 6.1, 1.7, 320, 10)

-- the window: bars between the sun and the board
local dark = gr.material{kd = {.02, .02, .02}}
local sun = gr.vec(-.80, .36, -.48):normalize()
local side = sun:cross(gr.vec(0, 1, 0)):normalize()
local up = side:cross(sun)
local function bar(u0, u1, v0, v1)
    local c = sun * 30
    scene:add_child(gr.rectangle{material = dark, corner = c + side * u0 + up * v0, along = side * (u1 - u0), up = up * (v1 - v0)})
end
bar(-30, -5.2, -30, 30) bar(6.2, 30, -30, 30) bar(-5.2, 6.2, 3.6, 30) bar(-5.2, 6.2, -30, -6) bar(.3, .75, -6, 3.6) bar(-5.2, 6.2, -1.1, -.75)
-- candles and books far behind
for k = 1, 60 do
    local h = dice:range(1.6, 2.6)
    scene:add_child(gr.box{material = gr.openpbr_material{base_color = gr.vec(.42, .2, .09) * (.3 + dice:number()) + gr.vec(.02, .02, .05) * dice:number()}, min = {-13 + .42 * k, 0, -15}, max = {-13 + .42 * k + .38, h, -14}}:translate(0, -.42, 0))
end
for _, c in ipairs{{5.0, 2.2, .34, 1}, {3.4, 1.5, .15, .8}, {-5.6, 2.7, .2, .5}, {-6.3, 2.3, .13, .6}} do
    scene:add_child(gr.sphere{material = gr.material{kd = {0, 0, 0}, emission = gr.vec(2.6, 1.05, .28) * c[4]}, centre = {c[1], c[2], -13.8}, radius = c[3]})
end
scene:add_child(gr.box{material = gr.openpbr_material{base_color = {.10, .085, .07}}, min = {-17, -1, -16.2}, max = {40, 30, -16}})
gr.render{node = scene, file = 'endgame.png', width = 1600, height = 1000, eye = {.9, 2.75, 8.6}, target = {.05, .55, 0}, fov = 29, aperture = .09, focus_point = {-.2, .8, .2}, blades = 9,
    integrator = 'path', denoise = true, tone = 'filmic', exposure = .5, clamp = 12, max_depth = 6, vignette = .2, background = {.03, .035, .05},
    lights = {gr.spherical_light{position = sun * 60, radius = .7, emission = {16000, 9600, 4400}}, gr.sky_light{sky = {.10, .12, .17}}}}
