-- The room of the two final scenes: a table with tea things before a window, a mirror in a carved frame, a lamp.
-- Author: gray project
--
-- Units are metres, y is up. The room is built for a view along -z, with the window wall at z = -2.2; at the
-- end the whole room is rotated by 180 degrees, so that the window faces the evening sun of the sky image (its +z
-- face). No surfaces coincide: objects sink into their support by a fraction of a millimetre.

local meshes = require 'mesh_tools'
local lathe = require 'lathe'
local sweep = require 'sweep'
local carve = require 'carve'
local bezier = require 'bezier'
local teapot = require 'teapot'
local noise = require 'noise'

local M = {}

local sin, cos, pi, sqrt = math.sin, math.cos, math.pi, math.sqrt

--- Converts positions and directions of the room as built to those of the finished scene.
function M.place(p) return { -p[1], p[2], -p[3] } end

local function box(name, material, low, high)
    local node = gr.geometry(name, gr.cube(material))
    node:scale(high[1] - low[1], high[2] - low[2], high[3] - low[3])
    node:translate(low[1], low[2], low[3])
    return node
end

local function ball(name, material, centre, radius)
    local node = gr.geometry(name, gr.sphere(material))
    node:scale(radius, radius, radius)
    node:translate(centre[1], centre[2], centre[3])
    return node
end

local function smooth(name, material, mesh)
    return gr.geometry(name, gr.vn_mesh(material, mesh[1], mesh[2], mesh[3], mesh[4]))
end

local function turned(name, material, profile, segments)
    return smooth(name, material, { lathe.turn(profile, segments) })
end

--- A raised panel of joinery: a flat field inside a bevel. Its object space is stretched so that wood grain stands upright.
local function panel(name, material, width, height, depth)
    local b, d = 0.05, depth
    local x, y = width / 2, height / 2
    local verts, faces = {}, {}
    local rings = { { 0, 0 }, { 0.004, d * 0.5 }, { b, d * 0.55 }, { b + 0.004, d * 0.85 }, { b + 0.035, d } }
    for _, r in ipairs(rings) do
        local i, z = r[1], r[2]
        for _, c in ipairs { { -1, -1 }, { 1, -1 }, { 1, 1 }, { -1, 1 } } do
            verts[#verts + 1] = { c[1] * (x - i), c[2] * (y - i), z }
        end
    end
    for k = 0, #rings - 2 do
        for c = 0, 3 do
            faces[#faces + 1] = { 4 * k + c, 4 * k + (c + 1) % 4, 4 * k + 4 + (c + 1) % 4, 4 * k + 4 + c }
        end
    end
    local top = 4 * (#rings - 1)
    faces[#faces + 1] = { top, top + 1, top + 2, top + 3 }
    local stretch = 4
    for _, p in ipairs(verts) do p[1], p[3] = p[1] * stretch, p[3] * stretch end
    local node = gr.geometry(name, gr.mesh(material, verts, faces))
    node:scale(1 / stretch, 1, 1 / stretch)
    return node
end

--- A moulding: a profile of {out, up} carried along x from x0 to x1.
local function moulding(name, material, profile, x0, x1)
    local verts, faces = {}, {}
    local n = #profile
    for _, x in ipairs { x0, x1 } do
        for _, p in ipairs(profile) do verts[#verts + 1] = { x, p[2], p[1] } end
    end
    for i = 0, n - 1 do
        local j = (i + 1) % n
        faces[#faces + 1] = { i, n + i, n + j, j }
    end
    local left, right = {}, {}
    for i = 1, n do left[i], right[n + 1 - i] = i - 1, n + i - 1 end
    faces[#faces + 1], faces[#faces + 2] = left, right
    local mesh = meshes.smooth(verts, faces, 35)
    return smooth(name, material, mesh)
end

--- Where the pictures are, from the folder of the scene.
M.textures = '../textures/'

function M.materials()
    local m = {}
    m.wall = gr.material({ .58, .60, .50 }, { 0, 0, 0 }, 1)
    m.ceiling = gr.material({ .78, .75, .68 }, { 0, 0, 0 }, 1)
    m.white = gr.material({ .76, .73, .66 }, { .12, .12, .12 }, 30)
    m.oak = gr.wood_pnd_material(gr.material({ .36, .20, .10 }, { .10, .09, .07 }, 25), 1.0, 6, 1, { .31, .17, .085 })
    m.oak_dark = gr.material({ .22, .12, .06 }, { .12, .10, .08 }, 30)
    m.parquet = gr.td_cube_material(gr.material({ .5, .3, .2 }, { .12, .11, .10 }, 40), M.textures .. 'parquet.png')
    m.rug = gr.td_cube_material(gr.material({ .5, .1, .1 }, { 0, 0, 0 }, 1), M.textures .. 'rug.png')
    m.gold = gr.material({ .48, .33, .11 }, { .55, .42, .20 }, 22)
    m.brass = gr.rr_material({ .40, .27, .10 }, { .80, .62, .32 }, 45, .22, 0, 1)
    m.carved = gr.material({ .40, .20, .10 }, { .34, .27, .19 }, 36)
    m.mirror = gr.rr_material({ .02, .02, .02 }, { .88, .90, .90 }, 200, 1, 0, 1)
    m.marble = gr.marble_pnd_material(gr.rr_material({ .80, .77, .72 }, { .45, .45, .45 }, 120, .42, 0, 1),
        1.5, 4.2, 9.0, 1, { .50, .44, .41 })
    m.china = gr.rr_material({ .72, .72, .70 }, { .50, .50, .50 }, 140, .12, 0, 1)
    m.glaze = gr.rr_material({ .10, .26, .30 }, { .55, .58, .58 }, 120, .22, 0, 1)
    m.tea = gr.rr_material({ .22, .08, .02 }, { .5, .45, .4 }, 200, .25, 0, 1)
    m.vase = gr.marble_pnd_material(gr.rr_material({ .10, .16, .42 }, { .5, .5, .5 }, 120, .16, 0, 1),
        5, 3.5, 26, 1, { .80, .82, .84 })
    m.glass = gr.difresnel_material(gr.rr_material({ 0, 0, 0 }, { .97, .98, .97 }, 300, 0, 1, 1.5))
    m.crystal = gr.difresnel_material(gr.rr_material({ 0, .01, .01 }, { .96, 1, .98 }, 300, 0, 1, 1.5))
    m.leaf = gr.material({ .13, .28, .08 }, { .10, .12, .08 }, 20)
    m.curtain = gr.material({ .50, .17, .13 }, { .05, .04, .04 }, 10)
    m.glow = gr.material({ 4.5, 3.8, 2.6 }, { 0, 0, 0 }, 1)
    m.shade = gr.material({ .55, .50, .40 }, { .25, .25, .22 }, 30)
    m.ball = gr.td_sphere_material(gr.material({ .8, .8, .8 }, { .4, .4, .4 }, 90), M.textures .. 'ball.png')
    m.orange = gr.material({ .78, .36, .05 }, { .18, .15, .10 }, 20)
    m.label = gr.td_cube_material(gr.material({ .5, .5, .5 }, { .25, .25, .25 }, 40), M.textures .. 'label.png')
    m.painting = gr.td_cube_material(gr.material({ .5, .5, .5 }, { .06, .06, .06 }, 20), M.textures .. 'painting.png')
    return m
end

M.ambient = { .28, .28, .29 }

-- The shell -----------------------------------------------------------------------------------------------------------

M.left, M.right, M.back, M.front, M.top = -2.5, 2.9, -2.2, 4.2, 2.8
M.window = { x0 = -1.95, x1 = -0.45, y0 = 1.02, y1 = 2.42 }

local function shell(m)
    local room = gr.node('shell')
    local w = M.window
    -- the wall with the window: two piers, and two pieces between them a hair's breadth behind
    local behind = M.back - .0002
    room:add_child(box('left pier', m.wall, { M.left - .3, -.1, M.back - .3 }, { w.x0, M.top + .1, M.back }))
    room:add_child(box('right pier', m.wall, { w.x1, -.1, M.back - .3 }, { M.right + .3, M.top + .1, M.back }))
    room:add_child(box('parapet', m.wall, { w.x0 - .001, -.1, M.back - .3 }, { w.x1 + .001, w.y0, behind }))
    room:add_child(box('lintel', m.wall, { w.x0 - .001, w.y1, M.back - .3 }, { w.x1 + .001, M.top + .1, behind }))
    room:add_child(box('left wall', m.wall, { M.left - .2, -.1, M.back - .1 }, { M.left, M.top + .1, M.front + .1 }))
    room:add_child(box('right wall', m.wall, { M.right, -.1, M.back - .1 }, { M.right + .2, M.top + .1, M.front + .1 }))
    room:add_child(box('front wall', m.wall, { M.left - .1, -.1, M.front }, { M.right + .1, M.top + .1, M.front + .2 }))
    room:add_child(box('ceiling', m.ceiling, { M.left - .1, M.top, M.back - .1 }, { M.right + .1, M.top + .2, M.front + .1 }))
    room:add_child(box('under floor', m.oak_dark, { M.left - .1, -.2, M.back - .1 }, { M.right + .1, -.03, M.front + .1 }))
    local tile = gr.geometry('parquet', gr.cube(m.parquet))
    tile:scale(1.3997, .05, 1.3997)
    tile:translate(0, -.05, 0)
    for i = 0, 3 do
        for j = 0, 4 do
            local at = gr.node(('floor %d %d'):format(i, j))
            at:translate(M.left - .05 + 1.4 * i, 0, M.back - .05 + 1.4 * j)
            at:add_child(tile)
            room:add_child(at)
        end
    end
    return room
end

--- Panels along a wall of a given length, seen along -z, standing at z = 0 from x = 0 to x = length.
local function wainscot(m, length)
    local row = gr.node('wainscot')
    local high = 0.84
    local count = math.floor(length / 0.62 + 0.5)
    local step = length / count
    row:add_child(box('board', m.oak_dark, { 0, -.01, -.02 }, { length, high, .012 }))
    local one = panel('panel', m.oak, step - .09, high - .22, .026)
    for i = 0, count - 1 do
        local at = gr.node('panel ' .. i)
        at:translate((i + .5) * step, .12 + (high - .22) / 2, .0118)
        at:add_child(one)
        row:add_child(at)
    end
    row:add_child(moulding('dado', m.oak_dark,
        { { 0, high - .005 }, { .03, high }, { .034, high + .012 }, { .048, high + .022 }, { .050, high + .04 },
          { .036, high + .052 }, { 0, high + .056 } }, 0, length))
    row:add_child(moulding('skirting', m.oak_dark,
        { { 0, -.01 }, { .035, -.01 }, { .035, .075 }, { .028, .09 }, { .018, .098 }, { 0, .10 } }, 0, length))
    return row
end

local function cornice(m, length)
    local profile = { { 0, -.14 }, { .012, -.14 }, { .016, -.125 } }
    for i = 0, 6 do
        local a = pi / 2 * i / 6
        profile[#profile + 1] = { .02 + .085 * (1 - cos(a)), -.115 + .085 * sin(a) }
    end
    profile[#profile + 1] = { .115, -.025 }
    profile[#profile + 1] = { .12, .01 }
    profile[#profile + 1] = { 0, .01 }
    return moulding('cornice', m.white, profile, 0, length)
end

local function joinery(m)
    local all = gr.node('joinery')
    local function along(make, lift)
        local wide, deep = M.right - M.left, M.front - M.back
        local spots = {
            { make(m, wide), 0, M.left, M.back }, { make(m, deep), 90, M.left, M.front },
            { make(m, deep), -90, M.right, M.back }, { make(m, wide), 180, M.right, M.front },
        }
        for _, s in ipairs(spots) do
            s[1]:rotate('y', s[2])
            s[1]:translate(s[3], lift, s[4])
            all:add_child(s[1])
        end
    end
    along(wainscot, 0)
    along(cornice, M.top)
    return all
end

-- The window ----------------------------------------------------------------------------------------------------------

local function window(m)
    local w, all = M.window, gr.node('window')
    local cx = (w.x0 + w.x1) / 2
    local z = M.back - .12
    -- sash: a board with six panes cut out
    local sash = box('sash', m.white, { w.x0 - .005, w.y0 - .005, z - .025 }, { w.x1 + .005, w.y1 + .005, z + .025 })
    local panes
    local rail, columns, rows = .05, 3, 2
    local pw = (w.x1 - w.x0 - rail * (columns + 1)) / columns
    local ph = (w.y1 - w.y0 - rail * (rows + 1)) / rows
    for i = 0, columns - 1 do
        for j = 0, rows - 1 do
            local x, y = w.x0 + rail + i * (pw + rail), w.y0 + rail + j * (ph + rail)
            local pane = box('pane', m.white, { x, y, z - .1 }, { x + pw, y + ph, z + .1 })
            panes = panes and gr.csg_union('panes', panes, pane) or pane
        end
    end
    all:add_child(gr.csg_difference('window frame', sash, panes))
    all:add_child(box('glass', m.glass, { w.x0 + .01, w.y0 + .01, z - .003 }, { w.x1 - .01, w.y1 - .01, z + .003 }))
    all:add_child(box('sill', m.white, { w.x0 - .10, w.y0 - .035, M.back - .09 }, { w.x1 + .10, w.y0 + .004, M.back + .055 }))
    -- casing around the hole
    all:add_child(box('casing', m.white, { w.x0 - .085, w.y1 - .001, M.back - .01 }, { w.x1 + .085, w.y1 + .10, M.back + .022 }))
    for _, x in ipairs { w.x0 - .08, w.x1 - .001 } do
        all:add_child(box('casing', m.white, { x, w.y0 - .02, M.back - .01 }, { x + .081, w.y1 + .001, M.back + .0215 }))
    end
    -- curtains on a brass rod
    local rod_y, rod_z = w.y1 + .17, M.back + .11
    local rod = { lathe.turn({ { 0, -1.06 }, { .014, -1.06 }, { .014, -1.06 }, { .014, 1.06 }, { .014, 1.06 }, { 0, 1.06 } }, 16) }
    local bar = smooth('rod', m.brass, meshes.rotate(rod, 'z', 90))
    bar:translate(cx, rod_y, rod_z)
    all:add_child(bar)
    for _, side in ipairs { -1, 1 } do
        all:add_child(ball('finial', m.brass, { cx + side * 1.07, rod_y, rod_z }, .03))
    end
    local function curtain(side)
        local high, folds = rod_y - .30, 5
        return meshes.net(40, folds * 14, function(i, j)
            local v, u = i / 40, j / (folds * 14)
            -- gathered by a band at a third of the height
            local gather = 1 - .46 * math.exp(-((v - .36) / .22) ^ 2) - .05 * v
            local width = .52 * gather
            local depth = .026 + .010 * (1 - v) + .008 * sin(5 * u + 3 * v)
            local phase = 2 * pi * folds * u + .5 * sin(4 * v + u * 6)
            local x = side * (1.03 - width * u)
            return x, .28 + high * v, depth * sin(phase) + .012 * sin(9 * u)
        end)
    end
    for _, side in ipairs { -1, 1 } do
        local mesh = curtain(side)
        if side > 0 then mesh = meshes.flip(mesh) end
        local node = smooth('curtain', m.curtain, mesh)
        node:translate(cx, 0, rod_z)
        all:add_child(node)
        local band = {}
        for i = 0, 24 do
            local a = 2 * pi * i / 25
            band[i + 1] = { .155 * cos(a), 0, .06 * sin(a) }
        end
        local tie = smooth('tie', m.gold, { sweep.tube(band, .013, 10, { closed = true }) })
        tie:rotate('z', side * 8)
        tie:translate(cx + side * .885, .28 + (rod_y - .30) * .36, rod_z)
        all:add_child(tie)
    end
    return all
end

--- Hills and a line of firs outside. Only the ambient light reaches them, so their colours are brighter.
local function outside(ambient)
    local all = gr.node('outside')
    local layers = {
        { z = -5.6, colour = { .72, .53, .50 }, low = 1.46, high = .30, f = 1.1, seed = 3.2 },
        { z = -5.0, colour = { .50, .36, .38 }, low = 1.36, high = .20, f = 1.7, seed = 9.1 },
        { z = -4.4, colour = { .29, .22, .24 }, low = 1.24, high = .13, f = 2.4, seed = 17.4 },
    }
    local function strip(name, colour, z, top, count)
        local verts, faces = {}, {}
        for i = 0, count do
            local x = -5.5 + 7.5 * i / count
            verts[#verts + 1] = { x, .2, z }
            verts[#verts + 1] = { x, top(x, i), z }
            if i > 0 then
                local k = 2 * i
                faces[i] = { k - 2, k, k + 1, k - 1 }
            end
        end
        local c = { colour[1] / ambient[1], colour[2] / ambient[2], colour[3] / ambient[3] }
        all:add_child(gr.geometry(name, gr.mesh(gr.material(c, { 0, 0, 0 }, 1), verts, faces)))
    end
    for k, layer in ipairs(layers) do
        strip('hills ' .. k, layer.colour, layer.z, function(x)
            local ridge = noise.sum(x * layer.f + layer.seed, layer.seed * 2, .5, 5)
            return layer.low + layer.high * (.35 + 1.1 * ridge)
        end, 300)
    end
    -- firs: each a stack of three saw teeth in outline
    strip('firs', { .10, .09, .10 }, -3.7, function(x, i)
        local tree = i // 16
        local u = math.abs((i % 16) / 16 - .5) * 2
        local size = .10 + .09 * (.5 + .5 * sin(tree * 2.4 + sin(tree * 1.7)))
        local tooth = (1 - u) - .10 * ((u * 5) % 1)
        return 1.03 + .07 * noise.noise(x * .8, 2.2, .1) + size * math.max(0, tooth)
    end, 1600)
    return all
end

-- The table -----------------------------------------------------------------------------------------------------------

M.table_height = 0.76

local function table_top(m)
    local y, r = M.table_height, .92
    local edge = lathe.spline({ { r - .09, y - .052 }, { r - .055, y - .047 }, { r - .03, y - .034 }, { r - .012, y - .028 },
                                { r - .003, y - .018 }, { r - .002, y - .009 }, { r - .008, y - .002 }, { r - .016, y } }, 4)
    local profile = { { 0, y - .052 }, { r - .09, y - .052 } }
    for _, p in ipairs(edge) do profile[#profile + 1] = p end
    profile[#profile + 1] = { r - .016, y }
    profile[#profile + 1] = { 0, y }
    -- veins follow the y axis of object space, so the top is made upright and then rotated
    local top = smooth('marble top', m.marble, meshes.rotate({ lathe.turn(profile, 160) }, 'z', 72))
    top:rotate('z', -72)
    top:rotate('y', -35)
    return top
end

--- The carved base: a baluster with winding gadroons and two rings of leaves, and four cabriole legs.
local function table_base(m, fine)
    local base = gr.node('table base')
    local shape = lathe.spline({ { .10, .24 }, { .105, .27 }, { .075, .30 }, { .09, .33 }, { .135, .40 }, { .150, .46 },
                                 { .125, .53 }, { .080, .58 }, { .062, .60 }, { .075, .625 }, { .060, .645 },
                                 { .085, .67 }, { .15, .695 }, { .24, .712 } }, math.floor(24 * fine))
    local low = carve.gadroons(22, .30, .13, .20, .62)
    local leaves = carve.leaves(9, .20, .80, .985)
    local foot = carve.leaves(11, .16, .015, .20)
    local column = lathe.carved(shape, math.floor(336 * fine), function(angle, t)
        return low(angle, t) * leaves(angle, t) * foot(angle, t)
    end)
    base:add_child(smooth('column', m.carved, column))
    base:add_child(turned('drop', m.carved, lathe.spline({ { 0, .13 }, { .02, .135 }, { .042, .16 }, { .03, .19 },
                                                           { .06, .21 }, { .11, .245 } }, 8), 64))
    -- the ring that carries the marble
    base:add_child(turned('apron', m.carved, { { .2, .690 }, { .46, .690 }, { .46, .690 }, { .475, .698 }, { .475, .698 },
                                               { .475, .709 }, { .475, .709 }, { .2, .709 } }, 96))
    local curve = {}
    for _, part in ipairs {
        { { .05, .34 }, { .20, .40 }, { .34, .36 }, { .40, .26 } },
        { { .40, .26 }, { .46, .16 }, { .50, .07 }, { .575, .055 } },
    } do
        for i, p in ipairs(bezier.curve(part, 40)) do
            if i > 1 or #curve == 0 then curve[#curve + 1] = { p[1], p[2], 0 } end
        end
    end
    local outline = {}
    local corners = 40
    for i = 0, corners - 1 do
        local a = 2 * pi * i / corners
        -- square with rounded edges and a bead along them
        local c, s = cos(a), sin(a)
        local k = 1 / (math.abs(c) ^ 4 + math.abs(s) ^ 4) ^ .25
        k = k * (1 + .07 * cos(8 * a))
        outline[i + 1] = { c * k, s * k }
    end
    local leg = { sweep.profile(curve, outline, {
        scale = function(t) return .048 - .026 * sin(pi * math.min(1, t * 1.15) * .9) + .010 * (1 - t) + .004 * carve.smoothstep(.85, 1, t) end,
    }) }
    local toe = { lathe.turn(lathe.spline({ { 0, -.004 }, { .03, .002 }, { .052, .03 }, { .05, .058 }, { .03, .085 }, { 0, .098 } }, 8), 48) }
    toe = meshes.translate(toe, .585, 0, 0)
    -- a leaf over the knee
    local knee = meshes.net(72, 40, function(i, j)
        local p, q = i / 72, (j / 40 - .5) * 2
        local at = curve[1 + math.floor(p * 34 + 6)]
        local next_point = curve[2 + math.floor(p * 34 + 6)]
        local f = p * 34 + 6 - math.floor(p * 34 + 6)
        local x, y = at[1] + (next_point[1] - at[1]) * f, at[2] + (next_point[2] - at[2]) * f
        local tx, ty = meshes.unit(next_point[1] - at[1], next_point[2] - at[2], 0)
        local lift = .036 + .020 * carve.leaf(p, q * .9) - .05 * q * q - .008
        return x - ty * lift, y + tx * lift, q * .043
    end)
    local mesh = meshes.merge { leg, toe, knee }
    local one = smooth('leg', m.carved, mesh)
    for k = 0, 3 do
        local at = gr.node('leg ' .. k)
        at:rotate('y', 20 + 90 * k)
        at:add_child(one)
        base:add_child(at)
    end
    M.base_polygons = #column[3] + 4 * #mesh[3]
    return base
end

-- Objects on the table
-- -------------------------------------------------------------------------------------------------

local function tea_set(m)
    local all = gr.node('tea set')
    local pot = gr.geometry('teapot', gr.vn_mesh(m.glaze, teapot.mesh(14)))
    pot:scale(.075, .075, .075)
    pot:rotate('y', 28)
    pot:translate(-.12, M.table_height - .0004, .05)
    all:add_child(pot)

    local cup_profile = lathe.spline({ { .026, 0 }, { .028, 0 }, { .027, .006 }, { .032, .012 }, { .046, .030 }, { .052, .055 },
                                       { .0545, .064 }, { .0530, .0655 }, { .0510, .064 }, { .0485, .055 }, { .043, .031 },
                                       { .030, .015 }, { 0, .013 } }, 6)
    table.insert(cup_profile, 1, { 0, .003 })
    local cup = meshes.new(lathe.turn(cup_profile, 56))
    local ear = {}
    for i, p in ipairs(bezier.curve({ { .046, .052 }, { .088, .066 }, { .088, .014 }, { .042, .024 } }, 20)) do
        ear[i] = { p[1], p[2], 0 }
    end
    local handle = meshes.new(sweep.tube(ear, .0042, 12))
    local saucer = meshes.new(lathe.turn(lathe.spline({ { 0, .002 }, { .030, .002 }, { .034, 0 }, { .038, .003 }, { .060, .010 },
                                                        { .078, .016 }, { .079, .018 }, { .076, .0185 }, { .056, .013 },
                                                        { .034, .008 }, { 0, .007 } }, 5), 56))
    local china = gr.vn_mesh(m.china, table.unpack(meshes.merge { meshes.translate(cup, 0, .0072, 0),
                                                                  meshes.translate(handle, 0, .0072, 0), saucer }))
    local tea = gr.vn_mesh(m.tea, lathe.turn({ { 0, .030 }, { .0478, .0545 }, { .0478, .0545 }, { 0, .0545 } }, 48))
    for k, at in ipairs { { -.50, .30, 200 }, { .16, .46, 15 }, { .50, -.10, -40 } } do
        local place = gr.node('cup ' .. k)
        place:add_child(gr.geometry('cup and saucer', china))
        local drink = gr.geometry('tea', tea)
        drink:translate(0, .0072, 0)
        place:add_child(drink)
        place:rotate('y', at[3])
        place:translate(at[1], M.table_height - .0004, at[2])
        all:add_child(place)
    end
    -- tea tin
    local tin = gr.node('tin')
    local body = gr.geometry('tin body', gr.cube(m.label))
    body:scale(.12, .15, .12)
    body:translate(-.06, 0, -.06)
    tin:add_child(body)
    local lid = box('tin lid', m.brass, { -.063, .1499, -.063 }, { .063, .166, .063 })
    tin:add_child(lid)
    tin:rotate('y', 14)
    tin:translate(-.44, M.table_height - .0004, -.12)
    all:add_child(tin)
    return all
end

local function flowers(m, count)
    local all = gr.node('flowers')
    local colours = { { .80, .12, .10 }, { .88, .42, .08 }, { .86, .70, .16 }, { .76, .22, .30 }, { .90, .82, .70 } }
    local heads = {}
    for k, c in ipairs(colours) do
        -- a tulip: six petals, as one pressed lathe
        local petal = lathe.spline({ { .002, 0 }, { .016, .006 }, { .026, .024 }, { .027, .044 }, { .019, .064 }, { .014, .070 } }, 6)
        local out = lathe.carved(petal, 72, function(angle, t)
            return 1 + .16 * math.abs(cos(1.5 * angle)) ^ .7 * t - .06
        end)
        local back = meshes.flip(out)
        local inner = {}
        for i, p in ipairs(back[1]) do inner[i] = { p[1] * .93, p[2] + .0005, p[3] * .93 } end
        heads[k] = gr.vn_mesh(gr.material(c, { .08, .08, .08 }, 15),
            table.unpack(meshes.merge { out, { inner, back[2], back[3], back[4] } }))
    end
    for k = 1, count do
        local a = 2.399963 * k + .6
        local reach = .05 + .085 * sqrt(k / count)
        local high = .245 - .28 * reach + .03 * sin(5 * k)
        local tip = { reach * cos(a), high, reach * sin(a) }
        local path = {}
        for i, p in ipairs(bezier.curve({ { .006 * cos(a), -.10, .006 * sin(a) }, { .010 * cos(a), .08, .010 * sin(a) },
                                          { tip[1] * .6, high * .7, tip[3] * .6 }, tip }, 14)) do path[i] = p end
        all:add_child(smooth('stem', m.leaf, { sweep.tube(path, .0032, 8) }))
        local head = gr.geometry('tulip', heads[k % #heads + 1])
        head:rotate('z', -math.deg(reach) * 5.2)
        head:rotate('y', -math.deg(a))
        head:translate(tip[1], tip[2] - .004, tip[3])
        all:add_child(head)
        -- a leaf beside it
        local b = a + 1.2
        local blade = meshes.net(16, 6, function(i, j)
            local t, q = i / 16, (j / 6 - .5) * 2
            local r = .012 + .10 * t ^ 1.4
            local y = -.02 + .20 * t - .11 * t * t
            local wide = .017 * sin(pi * (.08 + .92 * t)) ^ .8 * q
            return r * cos(b) - wide * sin(b), y + math.abs(wide) * .6, r * sin(b) + wide * cos(b)
        end)
        local under = meshes.flip(blade)
        all:add_child(smooth('leaf', m.leaf, meshes.merge { blade, meshes.translate(under, 0, -.0006, 0) }))
    end
    return all
end

local function vase(m)
    local all = gr.node('vase')
    local outline = lathe.spline({ { .040, 0 }, { .048, .004 }, { .046, .014 }, { .060, .045 }, { .080, .095 }, { .078, .14 },
                                   { .052, .185 }, { .036, .215 }, { .038, .235 }, { .054, .252 }, { .056, .255 },
                                   { .053, .256 }, { .036, .238 }, { .032, .215 }, { .046, .185 } }, 8)
    table.insert(outline, 1, { 0, 0 })
    all:add_child(turned('vase body', m.vase, outline, 96))
    local bunch = flowers(m, 9)
    bunch:translate(0, .235, 0)
    all:add_child(bunch)
    all:translate(.19, M.table_height - .0004, -.34)
    return all
end

-- Objects in the room
-- --------------------------------------------------------------------------------------------------

local function mirror(m, along, across)
    local all = gr.node('mirror')
    local w, h = .82, 1.12
    local verts, normals, faces, face_normals = carve.frame(w, h, { breadth = .17, depth = .085, along = along, across = across })
    M.frame_polygons = #faces
    all:add_child(gr.geometry('carved frame', gr.vn_mesh(m.gold, verts, normals, faces, face_normals)))
    all:add_child(box('looking glass', m.mirror, { -w / 2 - .01, -h / 2 - .01, -.02 }, { w / 2 + .01, h / 2 + .01, .004 }))
    -- it hangs a little forward
    all:rotate('x', 3.5)
    all:translate(1.62, 1.70, M.back + .05)
    return all
end

--- Shelves of books against the front wall; the mirror shows them.
local function bookcase(m)
    local all = gr.node('bookcase')
    local wide, high, deep = 1.16, 2.05, .30
    local case = gr.csg_difference('case', box('carcass', m.oak_dark, { 0, 0, 0 }, { wide, high, deep }),
        box('room for books', m.oak_dark, { .04, .12, .03 }, { wide - .04, high - .06, deep + .1 }))
    all:add_child(case)
    local colours = { { .42, .10, .08 }, { .12, .22, .16 }, { .10, .15, .30 }, { .45, .32, .14 }, { .30, .12, .20 },
                      { .55, .50, .40 }, { .20, .12, .08 } }
    local books = {}
    for k, c in ipairs(colours) do books[k] = gr.cube(gr.material(c, { .12, .11, .10 }, 20)) end
    local turn = 0
    for shelf = 0, 4 do
        local y = .12 + shelf * .372
        all:add_child(box('shelf', m.oak_dark, { .039, y - .02, .02 }, { wide - .039, y, deep - .01 }))
        local x = .05
        while x < wide - .10 do
            turn = turn + 1
            local thick = .028 + .022 * ((turn * 37) % 11) / 11
            local tall = .22 + .10 * ((turn * 53) % 13) / 13
            if (turn * 29) % 17 ~= 0 then
                local book = gr.geometry('book', books[(turn * 41 // 3) % #books + 1])
                book:scale(thick * .94, tall, .19)
                book:translate(x, y - .001, .06)
                all:add_child(book)
            end
            x = x + thick
        end
    end
    all:rotate('y', 180)
    all:translate(M.right - .05, 0, M.front - .06)
    return all
end

local function joke(m)
    local all = gr.node('painting')
    local w, h = .52, .39
    all:add_child(gr.geometry('small frame', gr.vn_mesh(m.oak_dark, carve.frame(w, h,
        { breadth = .055, depth = .035, along = 400, across = 20 }))))
    all:add_child(box('canvas', m.painting, { -w / 2 - .004, -h / 2 - .004, -.02 }, { w / 2 + .004, h / 2 + .004, .006 }))
    all:translate(.38, 1.62, M.back + .004)
    return all
end

--- A hanging lamp: a shell from two spheres, open below, pierced by a ring of holes, on a stem.
local function lamp(m)
    local all = gr.node('lamp')
    local shell_of = gr.csg_difference('shell', ball('outside', m.brass, { 0, 0, 0 }, .30), ball('inside', m.shade, { 0, -.006, 0 }, .288))
    local below = box('below', m.brass, { -.5, -.6, -.5 }, { .5, .035, .5 })
    local shade = gr.csg_difference('half', shell_of, below)
    local holes
    for k = 0, 13 do
        local a = 2 * pi * k / 14
        local hole = ball('hole', m.brass, { .262 * cos(a), .130, .262 * sin(a) }, .030)
        holes = holes and gr.csg_union('holes', holes, hole) or hole
    end
    all:add_child(gr.csg_difference('pierced shade', shade, holes))
    -- a rim: a flat ring, also cut with spheres
    local ring = gr.csg_difference('rim',
        gr.csg_intersection('band', ball('outer', m.brass, { 0, 0, 0 }, .306), box('slab', m.brass, { -.4, .028, -.4 }, { .4, .052, .4 })),
        ball('inner', m.brass, { 0, 0, 0 }, .290))
    all:add_child(ring)
    -- the bulb, a cap, the stem
    all:add_child(ball('bulb', m.glow, { 0, .105, 0 }, .062))
    all:add_child(gr.csg_union('cap', ball('knob', m.brass, { 0, .315, 0 }, .035),
        gr.csg_union('socket', box('neck', m.brass, { -.014, .17, -.014 }, { .014, .32, .014 }), ball('collar', m.brass, { 0, .19, 0 }, .03))))
    all:add_child(box('stem', m.brass, { -.006, .33, -.006 }, { .006, 1.2, .006 }))
    return all
end

--- Everything, ready to render.
---@param options table  eye: position of the camera; fine: factor for the carving (1); extras: the revised scene's
---additions; materials: a function that changes the table of materials
---@return any root
---@return table lights
function M.build(options)
    local m = M.materials()
    if options.materials then options.materials(m) end
    local root = gr.node('room')
    root:add_child(shell(m))
    root:add_child(joinery(m))
    root:add_child(window(m))
    root:add_child(outside(options.ambient or M.ambient))
    root:add_child(table_top(m))
    root:add_child(table_base(m, options.fine or 1))
    root:add_child(tea_set(m))
    root:add_child(vase(m))
    root:add_child(mirror(m, options.frame_along or 720, options.frame_across or 44))
    root:add_child(joke(m))
    root:add_child(bookcase(m))
    local hanging = lamp(m)
    hanging:translate(0, 1.86, 0)
    root:add_child(hanging)
    local rug = gr.geometry('rug', gr.cube(m.rug))
    rug:scale(3.3, .013, 2.2)
    rug:translate(-1.65, -.001, -1.1)
    rug:translate(0, 0, .1)
    root:add_child(rug)
    root:add_child(ball('ball', m.ball, { 1.18, .172, .42 }, .16))
    if options.extras then options.extras(root, m, { box = box, ball = ball, smooth = smooth, turned = turned }) end
    root:rotate('y', 180)

    local w = M.window
    local function area(corner, v1, v2, colour, falloff)
        return gr.area_light(M.place(corner), M.place(v1), M.place(v2), colour, falloff)
    end
    local lights = {
        -- evening light that comes in at the window
        area({ w.x0 + .1, w.y0 + .1, M.back - .02 }, { w.x1 - w.x0 - .2, 0, 0 }, { 0, w.y1 - w.y0 - .2, 0 },
            { 1.15, .92, .66 }, { .6, .12, .12 }),
        -- the lamp over the table
        area({ -.12, 1.80, -.12 }, { .24, 0, 0 }, { 0, 0, .24 }, { 1.0, .84, .60 }, { .55, .1, .25 }),
        -- a weak light at the camera, whose shadows are hidden behind the objects that cast them
        gr.light(M.place(options.eye), { .50, .48, .46 }, { 1, .03, .01 }),
    }
    return root, lights
end

return M
