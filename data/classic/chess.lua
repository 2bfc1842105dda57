-- TITLE: Chess
-- A corner of a board with turned pawns, kings and a rook cut with CSG; the board reflects them.
-- Author: gray project. Dialect: project.

local lathe = require 'lathe'

local root = gr.node('board')
local white = gr.rr_material({ .80, .74, .60 }, { .4, .4, .4 }, 60, .15, 0, 1)
local black = gr.rr_material({ .16, .10, .08 }, { .5, .5, .5 }, 60, .20, 0, 1)
local light = gr.marble_pnd_material(gr.rr_material({ .85, .82, .75 }, { .4, .4, .4 }, 60, .25, 0, 1), 1.5, 5, 5, 1, { .6, .55, .5 })
local dark = gr.marble_pnd_material(gr.rr_material({ .12, .20, .16 }, { .4, .4, .4 }, 60, .25, 0, 1), 1.5, 5, 5, 1, { .4, .5, .42 })

for i = 0, 7 do
    for j = 0, 7 do
        local square = gr.geometry('square', gr.cube((i + j) % 2 == 0 and dark or light))
        square:scale(.996, .2, .996)
        square:translate(i - 4, -.2, j - 4)
        root:add_child(square)
    end
end
local frame = gr.geometry('frame', gr.cube(black))
frame:scale(9, .3, 9)
frame:translate(-4.5, -.35, -4.5)
root:add_child(frame)

local function profile(points) return lathe.spline(points, 6) end
local foot = { { 0, 0 }, { .34, 0 }, { .36, .05 }, { .34, .12 }, { .25, .17 }, { .26, .20 }, { .18, .26 } }
local function with_foot(rest)
    local points = table.move(foot, 1, #foot, 1, {})
    return profile(table.move(rest, 1, #rest, #points + 1, points))
end
local pawn = { lathe.turn(with_foot { { .12, .50 }, { .20, .56 }, { .12, .60 }, { .19, .68 }, { .20, .78 }, { .12, .90 }, { 0, .93 } }, 40) }
local king = { lathe.turn(with_foot { { .13, .80 }, { .24, .92 }, { .15, .98 }, { .26, 1.30 }, { .22, 1.36 }, { .08, 1.44 }, { .06, 1.5 }, { 0, 1.62 } }, 40) }

local function put(node, x, z)
    local at = gr.node('at')
    at:translate(x + .5, -.0005, z + .5)
    at:add_child(node)
    root:add_child(at)
end
local function rook(material)
    local tower = gr.geometry('tower', gr.vn_mesh(material, lathe.turn(with_foot { { .2, .6 }, { .2, .62 }, { .27, .68 }, { .27, .68 },
        { .27, .92 }, { .27, .92 }, { 0, .92 } }, 40)))
    local cuts
    for k = 0, 3 do
        local cut = gr.geometry('cut', gr.cube(material))
        cut:translate(-.5, 0, -.5)
        cut:scale(.9, .3, .09)
        cut:rotate('y', 45 * k)
        cut:translate(0, .82, 0)
        cuts = cuts and gr.csg_union('cuts', cuts, cut) or cut
    end
    local well = gr.geometry('well', gr.sphere(material))
    well:scale(.19, .16, .19)
    well:translate(0, .92, 0)
    return gr.csg_difference('rook', tower, gr.csg_union('all', cuts, well))
end

local white_pawn, black_pawn = gr.geometry('white pawn', gr.vn_mesh(white, table.unpack(pawn))),
    gr.geometry('black pawn', gr.vn_mesh(black, table.unpack(pawn)))
for _, p in ipairs { { -4, 2 }, { -3, 2 }, { -2, 1 }, { 0, 2 }, { 2, 2 }, { 3, 2 } } do put(white_pawn, p[1], p[2]) end
for _, p in ipairs { { -4, -3 }, { -2, -3 }, { -1, -1 }, { 1, -2 }, { 3, -3 } } do put(black_pawn, p[1], p[2]) end
put(gr.geometry('white king', gr.vn_mesh(white, table.unpack(king))), 0, 0)
put(gr.geometry('black king', gr.vn_mesh(black, table.unpack(king))), 2, -4)
put(rook(white), -1, 1)
put(rook(black), -3, -2)

gr.render {
    node = root, file = 'chess.png', width = 480, height = 360, eye = { 1.6, 3.2, 6.2 }, view = { -.28, -.55, -1 }, fov = 46,
    ambient = { .28, .28, .3 }, background = { .25, .30, .38 },
    lights = { gr.light({ -5, 8, 5 }, { .7, .68, .6 }, { 1, 0, 0 }), gr.light({ 6, 5, 2 }, { .2, .22, .3 }, { 1, 0, 0 }) },
}
