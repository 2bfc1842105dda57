-- TITLE: The town at the blue hour
-- OPTIONS: --size 400x250 --spp 8
-- LARGE: --spp 64
-- A wet street after rain: lit windows, lamps and the last light of the sky in the puddles. Houses are boxes whose windows
-- are functions of the point; ledges, roofs, lamps and cars are geometry. Fog is thicker near the ground.
local random = require 'random'
local scene = gr.node 'town'
local dice = random.new(29)
local function glow(r, g, b) return gr.material{kd = {0, 0, 0}, emission = {r, g, b}} end

-- a front: windows of .62 x 1.0 in cells of 1.1 x 1.7, two thirds of them dark; shop windows at the bottom.
-- Corners of houses are edges of cells; the tower has four columns of windows, which end below the clock
local function front(colour, warm, tower)
    local function window(p, s)
        local side = gr.max(s.normal.x, -s.normal.x) - .5
        local u, v = gr.where(side, p.z, tower and p.x + .2 or gr.max(p.x, -p.x) + .3) / 1.1, p.y / 1.7
        local fu, fv, cell = u % 1, v % 1, gr.vec(u // 1, v // 1, tower and .5 or gr.where(side, p.x // 1, p.z // 1))
        local pane = gr.smoothstep(.20, .215, fu) * gr.smoothstep(.80, .785, fu) * gr.smoothstep(.22, .235, fv) * gr.smoothstep(.86, .845, fv)
        if tower then pane = pane * gr.step(gr.max(u, -u), 2) * gr.step(v, 8) * gr.where(side, 0, 1) end
        local bar = gr.smoothstep(.018, .012, gr.max(fu - .5, .5 - fu)) + gr.smoothstep(.014, .009, gr.max(fv - .62, .62 - fv))
        return pane * (1 - gr.clamp(bar, 0, 1)) * gr.smoothstep(.6, .3, gr.max(s.normal.y, -s.normal.y)), fu, fv, cell
    end
    return gr.openpbr_material{
        base_color = function(p, s)
            local pane = window(p, s)
            return gr.mix(colour * (1 - .22 * gr.turbulence(p * gr.vec(.5, .22, .5), 4)), gr.vec(.02, .025, .03), pane)
        end,
        specular_roughness = function(p, s) return gr.mix(.7, .06, (window(p, s))) end,
        emission_luminance = 1,
        emission_color = function(p, s)
            local pane, fu, fv, cell = window(p, s)
            local id = gr.hash(cell + gr.vec(.5, .5, .5))
            local on = gr.step(gr.where(cell.y - .5, .66, .35), id)
            local tone = gr.hash(cell + gr.vec(7.5, 3.5, .5))
            local room = .55 + .45 * gr.noise(fu * 3 + 10 * tone, fv * 4, 9 * id)       -- furniture and curtains
            local curtain = 1 - .55 * gr.smoothstep(.16, .10, gr.min(fu - .2, .8 - fu)) * gr.step(.4, tone)
            return gr.mix(gr.vec(1.5, .72, .22), gr.vec(1.3, 1.0, .62), tone) * (pane * on * room * curtain * (.35 + 1.1 * tone) * warm * (.55 + .6 * fv))
        end}
end
local fronts = {}
for i, c in ipairs{{.24, .17, .13}, {.20, .19, .19}, {.28, .22, .15}, {.14, .13, .15}, {.22, .13, .11}} do fronts[i] = front(gr.vec(table.unpack(c)), 1.9) end
local stone = gr.openpbr_material{base_color = {.22, .20, .18}, specular_roughness = .7}
local slate = gr.openpbr_material{base_color = {.045, .048, .055}, specular_roughness = .35}
local iron = gr.openpbr_material{base_color = {.02, .022, .022}, specular_roughness = .4}

-- the two rows: houses with ledges and roofs of their own heights
local function house(x0, x1, z0, z1, height, kind)
    scene:add_child(gr.box(fronts[kind], {x0, 0, z0}, {x1, height, z1}))
    local function ledge(y, out, thick) scene:add_child(gr.box{material = stone, min = {x0 - out, y, z0 - .5 * out}, max = {x1 + out, y + thick, z1 + .5 * out}}) end
    ledge(height, .28, .22) ledge(height - .30, .14, .14) ledge(1.72, .16, .16)
    for floor = 2, math.floor(height / 1.7) - 1 do ledge(1.7 * floor + .22, .05, .06) end
    if kind % 2 == 1 then                          -- a mansard roof with dormers, and chimneys
        local w = (x1 - x0) / 2
        scene:add_child(gr.prism{material = slate, outline = {{-w, 0}, {w, 0}, {w - .9, 1.9}, {-w + .9, 1.9}}, from = -z1, to = -z0}
            :rotate('x', -90):scale(1, 1, -1):translate((x0 + x1) / 2, height + .2, 0))
    end
    for _ = 1, 2 do
        local x, z = dice:range(x0 + .6, x1 - .6), dice:range(z0 + .5, z1 - .5)
        scene:add_child(gr.box{material = stone, min = {x - .22, height, z - .3}, max = {x + .22, height + dice:range(2.0, 2.9), z + .3}})
    end
end
for side = -1, 1, 2 do
    local z = 5.5
    while z > -95 do
        local depth, height = 1.1 * math.floor(dice:range(5, 9.5)), 1.7 * math.floor(dice:range(5, 9.4))
        if side > 0 then house(5.2, 5.2 + 8, z - depth, z - .04, height, math.ceil(dice:range(0, 5))) else house(-5.2 - 8, -5.2, z - depth, z - .04, height, math.ceil(dice:range(0, 5))) end
        z = z - depth
    end
end
-- the tower at the end, with a clock
scene:add_child(gr.box(front(gr.vec(.20, .19, .19), 1.9, true), {-3.2, 0, -112}, {2.8, 19, -104}))
scene:add_child(gr.box{material = stone, min = {-3.5, 19, -112.3}, max = {3.1, 19.6, -103.7}})
scene:add_child(gr.cone{material = slate, from = {-.2, 19.6, -108}, to = {-.2, 31, -108}, from_radius = 3.6, radius = .05})
scene:add_child(gr.cylinder{material = glow(2.6, 2.1, 1.2), from = {-.2, 16.5, -104}, to = {-.2, 16.5, -103.85}, radius = 1.3})
for _, hand in ipairs{{155, .75, .13}, {60, 1.1, .09}} do     -- ten past five
    local a = math.rad(hand[1])
    scene:add_child(gr.cylinder{material = iron, from = {-.2, 16.5, -103.8}, to = {-.2 + hand[2] * math.sin(a), 16.5 + hand[2] * math.cos(a), -103.8}, radius = hand[3]})
end

-- the wet street, kerbs and pavements; far away puddles are more ragged, and the middle of the street is higher and dry
local function wet(p)
    local n, far = gr.noise(p.x * .32, 2, p.z * .13) + .4 * gr.noise(p.x * 1.1, 5, p.z * .6), gr.smoothstep(1, -7, p.z)
    n = n + gr.mix(.08, .3, far) * gr.noise(p.x * 2.7, 8, p.z * 1.9) - .5 * far * gr.smoothstep(1.7, .4, gr.max(p.x, -p.x))
    return gr.smoothstep(-.14, .24, n)
end
local street = gr.openpbr_material{specular_ior = 1.33,
    base_color = function(p) return gr.vec(.030, .031, .034) * (1 + .5 * gr.noise(p * 14)) end,
    specular_roughness = function(p) return gr.mix(.26, .025, wet(p)) end,
    geometry_normal = gr.bump(function(p) return (1 - wet(p)) * (.22 * gr.noise(p * 40) + .25 * gr.noise(p * 9)) + .07 * gr.noise(p * 2) end, .006)}
scene:add_child(gr.plane{material = street, normal = {0, 1, 0}})
for side = -1, 1, 2 do
    scene:add_child(gr.box{material = street, min = {side * 4.35 - .85, -.1, -100}, max = {side * 4.35 + .85, .12, 8}, edge = .03})
    for k = 0, 8 do                                -- lamps: post, arm, glowing globe
        local x, z = side * 3.75, 1 - 11 * k - (side > 0 and 5.5 or 0)
        scene:add_child(gr.cone{material = iron, from = {x, 0, z}, to = {x, 4.1, z}, from_radius = .075, radius = .045})
        scene:add_child(gr.cylinder{material = iron, from = {x, .1, z}, to = {x, .5, z}, radius = .12, edge = .03})
        scene:add_child(gr.sphere{material = glow(34, 17.5, 6), centre = {x, 4.33, z}, radius = .20})
        scene:add_child(gr.cone{material = iron, from = {x, 4.72, z}, to = {x, 4.5, z}, radius = .24})
    end
end
-- parked cars: a body and a cabin with bent sides, wheels, a bumper, tail lamps
local function car(x, z, colour)
    local paint = gr.openpbr_material{base_color = colour, coat_weight = 1, specular_roughness = .3}
    local glass = gr.openpbr_material{base_color = {.01, .01, .012}, specular_roughness = .03}
    -- side views, as pairs of height and length, become prisms across the street
    local function across(material, half, edge, outline)
        scene:add_child(gr.prism{material = material, outline = outline, from = -half, to = half, edge = edge}:rotate('z', 90):translate(x, 0, z))
    end
    across(paint, .80, .1, {{.24, -2.0}, {.62, -2.05}, {.80, -1.9}, {.90, -.9}, {.94, 1.2}, {.88, 1.95}, {.55, 2.05}, {.24, 1.98}})
    across(glass, .66, .1, {{.8, -1.2}, {1.33, -.45}, {1.38, .3}, {1.32, 1.05}, {.8, 1.65}})
    across(paint, .60, .015, {{1.32, -.42}, {1.40, .3}, {1.33, 1.0}, {1.29, 1.0}, {1.29, -.42}})
    scene:add_child(gr.box{material = iron, min = {x - .78, .30, z + 1.9}, max = {x + .78, .44, z + 2.12}, edge = .05})
    scene:add_child(gr.box{material = stone, min = {x - .24, .54, z + 1.9}, max = {x + .24, .65, z + 2.07}, edge = .01})
    for _, w in ipairs{{-.69, -1.25}, {.69, -1.25}, {-.69, 1.25}, {.69, 1.25}} do
        scene:add_child(gr.cylinder{material = iron, from = {x + w[1] - .12, .31, z + w[2]}, to = {x + w[1] + .12, .31, z + w[2]}, radius = .31, edge = .05})
    end
    for s = -1, 1, 2 do
        scene:add_child(gr.box{material = glow(.9, .02, .012), min = {x + .60 * s - .11, .66, z + 1.9}, max = {x + .60 * s + .11, .74, z + 2.045}, edge = .03})
    end
end
car(2.55, -4.2, {.25, .02, .02}) car(2.6, -10.2, {.03, .05, .12}) car(2.55, -21, {.3, .3, .3}) car(-2.6, -9, {.02, .08, .06}) car(-2.55, -15.4, {.35, .33, .3})

local sky = gr.sky_gradient{{-1, .01, .012, .03}, {-.02, .40, .20, .15}, {.05, .46, .26, .20}, {.16, .20, .21, .34}, {.4, .055, .10, .25}, {1, .018, .035, .11}}
gr.render{node = scene, file = 'bluehour.png', width = 1600, height = 1000, eye = {-.75, 1.55, 7}, target = {-.2, 3.35, -30}, fov = 42, background = sky,
    integrator = 'path', denoise = true, tone = 'filmic', exposure = .5, clamp = 8, max_depth = 5, bloom = .08, vignette = .2,
    fog = gr.height_fog{density = .010, base = 0, scale = 8, colour = {.16, .13, .17}}, lights = {gr.sky_light{sky = sky}}}
