-- TITLE: Chess: turned and cut pieces, each one solid
-- OPTIONS: --spp 8
-- A chess set whose pieces are unions, differences and intersections of lathes, cones and boxes.

local patterns = require 'patterns'
-- Wood of a trunk along y, turned and polished: rings across, fibres along.
local function wood(light, dark, gloss)
    return gr.openpbr_material {coat_weight = 0.5, coat_roughness = gloss, specular_roughness = 0.35, base_color = function(p)
        local rings = patterns.wood(gr.vec(p.x * 1.5 + 2.1, p.z * 1.5 + 0.7, p.y * 0.2))
        local fibre = gr.noise(p.x * 30, p.y * 2, p.z * 30)
        return gr.mix(light, dark, gr.clamp(0.7 * rings + 0.12 * fibre, 0, 1))
    end}
end
local light, dark = wood(gr.vec(0.68, 0.48, 0.24), gr.vec(0.48, 0.29, 0.12), 0.15), wood(gr.vec(0.055, 0.032, 0.022), gr.vec(0.022, 0.012, 0.009), 0.10)
local white_square, black_square = wood(gr.vec(0.52, 0.36, 0.19), gr.vec(0.40, 0.25, 0.12), 0.08), wood(gr.vec(0.12, 0.055, 0.028), gr.vec(0.06, 0.026, 0.014), 0.08)
local frame = wood(gr.vec(0.16, 0.055, 0.024), gr.vec(0.07, 0.022, 0.01), 0.12)
local felt = gr.openpbr_material {base_color = {0.02, 0.06, 0.075}, fuzz_weight = 0.7, fuzz_color = {0.10, 0.22, 0.26}, specular_weight = 0}

-- Foot and stem of every piece, as one turned profile up to the collar at `height`. Those of a short one are flatter.
local function turned(height, width)
    local s = math.min(1, height / 0.62)
    return gr.lathe {spline = 'catmull-rom', points = {
        {0, 0}, {width * 0.93, 0.01 * s}, {width, 0.06 * s}, {width * 0.98, 0.10 * s}, {width * 0.88, 0.14 * s}, {width * 0.86, 0.17 * s},
        {width * 0.92, 0.20 * s}, {width * 0.84, 0.25 * s}, {width * 0.58, 0.34 * s}, {width * 0.42, 0.46 * s}, {width * 0.33, height * 0.76},
        {width * 0.36, height - 0.11 * s}, {width * 0.68, height - 0.08 * s}, {width * 0.74, height - 0.05 * s},
        {width * 0.66, height - 0.02 * s}, {width * 0.45, height}, {0, height},
    }}
end
local function ball(y, r) return gr.sphere {centre = {0, y, 0}, radius = r} end

local pieces = {}
function pieces.pawn()
    return gr.union('pawn', turned(0.72, 0.30), ball(0.86, 0.19))
end
function pieces.rook()
    local tower = gr.cone {from = {0, 0.75, 0}, from_radius = 0.19, to = {0, 1.20, 0}, radius = 0.27}
    local cuts = {gr.cylinder {from = {0, 1.05, 0}, to = {0, 1.3, 0}, radius = 0.17}}
    for k = 0, 2 do
        cuts[#cuts + 1] = gr.box {min = {-0.5, 1.10, -0.045}, max = {0.5, 1.3, 0.045}}:rotate('y', 60 * k)
    end
    return gr.union('rook', turned(0.78, 0.34), gr.difference('tower', tower, table.unpack(cuts)))
end
function pieces.bishop()
    local mitre = gr.lathe {spline = 'catmull-rom', points = {{0, 0.9}, {0.16, 0.95}, {0.22, 1.10}, {0.14, 1.30}, {0, 1.44}}}
    local slit = gr.box {min = {-0.03, 1.16, -0.4}, max = {0.03, 1.7, 0.4}}:translate(0, -1.16, 0):rotate('z', -32):translate(0.02, 1.16, 0)
    return gr.union('bishop', turned(0.95, 0.33), gr.difference('mitre', mitre, slit), ball(1.47, 0.06))
end
function pieces.knight()
    local side = {{-0.30, 0.0}, {-0.34, 0.25}, {-0.26, 0.55}, {-0.10, 0.78}, {0.02, 0.90}, {0.06, 0.76}, {0.20, 0.62}, {0.36, 0.42},
        {0.34, 0.30}, {0.20, 0.30}, {0.08, 0.36}, {0.16, 0.20}, {0.24, 0.0}}
    local head = gr.prism {outline = side, spline = 'catmull-rom', from = -0.16, to = 0.16}:rotate('x', -90)
    local shaped = gr.intersection('head', head, gr.ellipsoid {centre = {0, 0.35, 0}, radii = {0.55, 0.62, 0.20}})
    local eye = gr.union(gr.sphere {centre = {0.12, 0.60, 0.16}, radius = 0.045}, gr.sphere {centre = {0.12, 0.60, -0.16}, radius = 0.045})
    local mouth = gr.box {min = {0.20, 0.345, -0.4}, max = {0.6, 0.37, 0.4}}
    return gr.union('knight', turned(0.42, 0.34), gr.difference('cut', shaped, eye, mouth):translate(-0.02, 0.40, 0))
end
function pieces.queen()
    local crown = gr.cone {from = {0, 1.1, 0}, from_radius = 0.15, to = {0, 1.48, 0}, radius = 0.29}
    local cuts = {gr.sphere {centre = {0, 1.58, 0}, radius = 0.21}}
    for k = 0, 7 do
        cuts[#cuts + 1] = gr.sphere {centre = {0.30, 1.50, 0}, radius = 0.085}:rotate('y', 45 * k)
    end
    return gr.union('queen', turned(1.15, 0.38), gr.difference('crown', crown, table.unpack(cuts)), ball(1.40, 0.11), ball(1.53, 0.06))
end
function pieces.king()
    local crown = gr.cone {from = {0, 1.2, 0}, from_radius = 0.15, to = {0, 1.56, 0}, radius = 0.25}
    local dome = gr.intersection('dome', gr.ellipsoid {centre = {0, 1.55, 0}, radii = {0.25, 0.10, 0.25}}, gr.plane {normal = {0, -1, 0}, distance = -1.55})
    local cross = gr.union('cross', gr.box {min = {-0.035, 1.60, -0.03}, max = {0.035, 1.90, 0.03}}, gr.box {min = {-0.11, 1.73, -0.03}, max = {0.11, 1.80, 0.03}})
    return gr.union('king', turned(1.25, 0.40), crown, dome, cross)
end

local scene = gr.node('chess')
local function put(name, material, file, rank, turn)
    scene:add_child(pieces[name]():set_material(material):rotate('y', turn or 0):translate(file - 4.5, 0, 4.5 - rank))
end

-- The board: every square but the last rank is drawn by one difference of a plate and grooves.
for file = 1, 8 do
    for rank = 1, 8 do
        local m = (file + rank) % 2 == 0 and black_square or white_square
        scene:add_child(gr.box {min = {file - 4.99, -0.2, 4.01 - rank}, max = {file - 4.01, 0, 4.99 - rank}, material = m})
    end
end
scene:add_child(gr.difference('frame', gr.box {min = {-4.7, -0.3, -4.7}, max = {4.7, 0.06, 4.7}}, gr.box {min = {-4, -0.2, -4}, max = {4, 1, 4}},
    gr.box {min = {-9, 0, -9}, max = {0, 1, 9}}:rotate('z', 40):translate(-4.62, 0.06, 0)):set_material(frame))
scene:add_child(gr.box {min = {-60, -0.5, -60}, max = {60, -0.3, 60}, material = felt})

-- A position some moves into the game: {piece, file, rank}.
local whites = {{'rook', 1, 1}, {'bishop', 3, 1}, {'queen', 4, 1}, {'rook', 6, 1}, {'king', 7, 1}, {'knight', 3, 3}, {'knight', 6, 3},
    {'bishop', 3, 4}, {'pawn', 1, 2}, {'pawn', 2, 2}, {'pawn', 3, 2}, {'pawn', 4, 3}, {'pawn', 5, 4}, {'pawn', 6, 2}, {'pawn', 7, 2}, {'pawn', 8, 2}}
local blacks = {{'rook', 1, 8}, {'bishop', 3, 8}, {'queen', 4, 8}, {'king', 5, 8}, {'rook', 8, 8}, {'knight', 3, 6}, {'knight', 6, 6},
    {'bishop', 3, 5}, {'pawn', 1, 7}, {'pawn', 2, 7}, {'pawn', 3, 7}, {'pawn', 4, 6}, {'pawn', 5, 5}, {'pawn', 6, 7}, {'pawn', 7, 7}, {'pawn', 8, 7}}
for _, p in ipairs(whites) do put(p[1], light, p[2], p[3], p[1] == 'knight' and 25 or 90) end
for _, p in ipairs(blacks) do put(p[1], dark, p[2], p[3], p[1] == 'knight' and 205 or 90) end

local sky = gr.sky_gradient {{-1, 0.03, 0.03, 0.035}, {0, 0.12, 0.13, 0.16}, {1, 0.42, 0.50, 0.62}}
gr.render {
    node = scene, file = 'chess.png', width = 480, height = 300, eye = {-5.0, 4.0, 8.6}, target = {0.05, 0.15, 0.35}, fov = 31,
    integrator = 'path', denoise = true, tone = 'filmic', exposure = 0.3, clamp = 12, max_depth = 5, background = {0.05, 0.06, 0.075},
    aperture = 0.05, focus_point = {0.4, 0.5, 2.4},
    lights = {gr.spherical_light {position = {-30, 22, -6}, radius = 1.6, emission = {620, 500, 350}}, gr.sky_light {sky = sky}},
}
