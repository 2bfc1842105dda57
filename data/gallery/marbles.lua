-- TITLE: Marbles in the morning
-- OPTIONS: --size 400x250 --spp 6 --caustics 400000
-- LARGE: --spp 100 --caustics 4000000
-- Glass with coloured vanes and bubbles on an old table, before a garden that is out of focus. Photons carry the light of the
-- low sun through the glass; the glass has the dispersion of flint, so the rims of the bright spots have colours.
local patterns, random = require 'patterns', require 'random'
local scene = gr.node 'marbles'
local dice = random.new(5)

-- the table: boards along x, each from another part of the trunk, with worn finish and dark joints
local width = 3.1
local function board(p) return gr.vec(0, 0, p.z / width - p.z / width % 1) end
local function joint(p) local z = p.z / width % 1 return gr.smoothstep(.0, .012, gr.min(z, 1 - z)) end
local wood = gr.openpbr_material{
    base_color = function(p)
        local part = gr.hash(board(p))
        local grain = patterns.wood(gr.vec(p.y * .4, (p.z - 3 * part) * .55, p.x * .07 + 7 * part) + gr.vec(1.2, .3, 0))
        local fibre = gr.noise(p.x * .8, 5 * part, p.z * 26) * .5 + .5
        local colour = gr.mix(gr.vec(.30, .145, .06), gr.vec(.13, .052, .02), grain) * (.75 + .3 * part) * (.8 + .35 * fibre)
        return gr.mix(gr.vec(.012, .008, .006), colour, joint(p))
    end,
    specular_roughness = function(p) return .44 + .16 * gr.noise(p * 1.3) + .10 * gr.noise(p.x * 1.5, 0, p.z * 22) end,
    geometry_normal = gr.bump(function(p) return .6 * gr.noise(p.x * .8, 0, p.z * 26) + 5 * joint(p) end, .006)}
scene:add_child(gr.box(wood, {-40, -1, -14}, {40, 0, 12}))

-- a marble at (x, z): glass with three or four vanes, or opaque glass with swirls
local function glass(tint, depth)
    return gr.openpbr_material{transmission_weight = 1, transmission_color = tint, transmission_depth = depth, specular_roughness = 0,
        specular_ior = 1.54, transmission_dispersion_abbe_number = 32, transmission_dispersion_scale = 1}
end
local function marble(x, z, r, tint, vanes, count)
    local node = gr.node 'marble'
    node:add_child(gr.sphere{material = glass(tint, 2.5), radius = 1})
    for s = 1, count do
        local colour = vanes[(s - 1) % #vanes + 1]
        local core = gr.openpbr_material{base_color = colour, specular_roughness = .3, specular_weight = .3}
        for edge = 0, 9 do                         -- a vane is a row of fine threads from the axis outwards
            local points, radii = {}, {}
            for k = -6, 6 do
                local a = 2 * math.pi * s / count + .13 * k + .03 * edge
                local reach = (.06 + .048 * edge) * math.cos(k / 6 * 1.45)
                points[#points + 1] = {reach * math.cos(a), .12 * k, reach * math.sin(a)}
                radii[#radii + 1] = (.012 + .034 * math.cos(k / 6 * 1.5)) * (1 - .06 * edge)
            end
            node:add_child(gr.sweep(core, points, radii))
        end
    end
    for _ = 1, 5 do                                -- bubbles
        local d = gr.vec(dice:range(-.6, .6), dice:range(-.6, .6), dice:range(-.6, .6))
        node:add_child(gr.sphere{material = glass({1, 1, 1}, 0), centre = d, radius = dice:range(.012, .03)})
    end
    scene:add_child(node:rotate('x', dice:range(-75, 75)):rotate('y', dice:range(0, 360)):rotate('z', dice:range(-60, 60)):scale(r, r, r):translate(x, r, z))
end
local function swirl(x, z, r, one, two)
    local material = gr.openpbr_material{specular_roughness = .03, base_color = function(p)
        local s = gr.smoothstep(.35, .62, patterns.marble(gr.vec(p.x + .4 * gr.noise(p * 2), p.y, p.z) * 1.1))
        return gr.mix(one, two, s)
    end}
    scene:add_child(gr.sphere{material = material, radius = 1}:rotate('x', 50):rotate('z', 20):scale(r, r, r):translate(x, r, z))
end
local clear, sea, honey, sky, rose = {.93, .97, .96}, {.25, .75, .55}, {.98, .68, .22}, {.35, .62, .95}, {.95, .35, .38}
local red, yellow, blue, white, green = {.75, .03, .03}, {.95, .60, .04}, {.03, .12, .62}, {.85, .85, .80}, {.05, .45, .12}
marble(0, 0, 1, clear, {blue, white}, 4)
marble(2.25, -.9, .88, honey, {red, yellow}, 2)
marble(-2.1, -1.1, .92, sea, {white, green}, 3)
marble(.9, -3.3, .9, clear, {red, yellow}, 3)
marble(-1.55, 1.9, .8, rose, {white}, 0)
marble(3.3, 1.5, .78, sky, {blue}, 0)
marble(-4.6, .7, .9, clear, {yellow, green}, 4)
swirl(-3.4, -4.2, 1, gr.vec(.75, .72, .62), gr.vec(.04, .22, .16))
swirl(4.9, -3.4, .95, gr.vec(.80, .30, .05), gr.vec(.85, .80, .68))
marble(-7.5, -3.2, .9, honey, {white, red}, 4)
marble(8.1, -6.2, .9, sea, {blue}, 3)
scene:add_child(gr.sphere{centre = {.75, .3, 2.3}, radius = .3, material = gr.metal_material{metal = 'chromium', roughness = .06}})

-- the garden, out of focus
for _ = 1, 420 do
    local far = dice:range(40, 80)
    local y, bright = dice:range(-.30, .42) * far, dice:range(0, 1) ^ 3
    local leaf = gr.mix(gr.vec(.03, .10, .012), gr.vec(1.2, .85, .22), bright) * dice:range(.3, 1.6)
    scene:add_child(gr.sphere{centre = {dice:range(-.75, .75) * far, y, -far}, radius = dice:range(.3, 1), material = gr.material{kd = {0, 0, 0}, emission = leaf}})
end
local sun = gr.vec(-.60, .62, -.72):normalize()
gr.render{node = scene, file = 'marbles.png', width = 1600, height = 1000, eye = {.5, 3.6, 8.6}, target = {.25, .5, -.4}, fov = 31, aperture = .14, focus_point = {0, 1, .8}, blades = 7,
    integrator = 'path', denoise = true, tone = 'filmic', exposure = .3, clamp = 16, max_depth = 14,
    background = gr.sky_gradient{{-1, .01, .025, .006}, {-.1, .015, .035, .01}, {.3, .05, .10, .03}, {1, .5, .6, .7}},
    lights = {gr.spherical_light{position = sun * 16, radius = 1.3, emission = {170, 122, 66}}, gr.sky_light{sky = {.16, .20, .26}}}}
