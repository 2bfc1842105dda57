-- TITLE: Chess: turned and cut pieces, each one solid
-- OPTIONS: -al-samples 3
-- A chess set whose pieces are unions, differences and intersections of lathes, cones and boxes.

local plaster = {0.9, 0.86, 0.76}
local ebony = {0.13, 0.09, 0.07}
local function wood(colour, grain)
    local base = gr.rr_material(colour, {0.35, 0.35, 0.35}, 70, 0.06, 0, 1)
    return gr.wood_pnd_material(base, 1.6, 9, 1, grain)
end
local light, dark = wood(plaster, {0.78, 0.66, 0.46}), wood(ebony, {0.26, 0.16, 0.10})
local felt = gr.material({0.20, 0.23, 0.27}, {0, 0, 0}, 1)
local frame = gr.wood_pnd_material(gr.rr_material({0.36, 0.19, 0.09}, {0.3, 0.3, 0.3}, 50, 0.05, 0, 1), 1.1, 7, 1, {0.22, 0.10, 0.05})
local white_square = gr.rr_material({0.80, 0.74, 0.62}, {0.2, 0.2, 0.2}, 50, 0.10, 0, 1)
local black_square = gr.rr_material({0.16, 0.11, 0.09}, {0.3, 0.3, 0.3}, 50, 0.14, 0, 1)

-- Foot and stem of every piece, as one turned profile up to the collar at `height`.
local function turned(height, width)
    return gr.lathe {spline = 'linear', points = {
        {0, 0}, {width, 0}, {width, 0.07}, {width * 0.92, 0.12}, {width * 0.95, 0.17}, {width * 0.80, 0.25}, {width * 0.55, 0.34},
        {width * 0.40, 0.50}, {width * 0.33, height * 0.75}, {width * 0.42, height - 0.10}, {width * 0.72, height - 0.07},
        {width * 0.72, height - 0.03}, {width * 0.45, height}, {0, height},
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

gr.render {
    node = scene, file = 'chess.png', width = 480, height = 300, eye = {-5.0, 4.4, 8.6}, target = {0.05, 0.1, 0.35}, fov = 33,
    ambient = {0.30, 0.30, 0.33}, background = {0.20, 0.23, 0.27},
    lights = {gr.area_light({-7, 9, 3}, {2.4, 0, 0}, {0, 0, 2.4}, {0.85, 0.80, 0.70}, {1, 0, 0}), gr.light({8, 6, 8}, {0.20, 0.22, 0.28}, {1, 0, 0})},
}
