-- One description of every shape and every combination, in two languages: as nodes of gray, or, with
-- -D POV=true, as scene files of POV-Ray on standard output. Surfaces have one colour each and no shading; black fog of
-- known density turns the picture into depth: depth = -log(brightness)/density.
gr.transform_order('new')

local WIDTH, HEIGHT, FOV, DENSITY, EYE = 200, 150, 36, 0.1, {2.6, 3.1, 6.2}
local COLOURS = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 0}, {1, 0, 1}, {0, 1, 1}, {1, 1, 1}}

local function v(p) return '<' .. p[1] .. ',' .. p[2] .. ',' .. p[3] .. '>' end
local function pairs_of(points)
    local words = {}
    for k, p in ipairs(points) do words[k] = '<' .. p[1] .. ',' .. p[2] .. '>' end
    return table.concat(words, ',')
end

-- An object in both languages: make(material) gives the node, sdl has %s for colour and transforms.
local function thing(make, sdl) return {make = make, sdl = sdl} end
local function placed(what, colour, scale, turn, move) return {what = what, colour = colour, scale = scale, turn = turn, move = move} end

local materials = {}
local function material(index)
    index = index or 7
    materials[index] = materials[index] or gr.material {kd = COLOURS[index], ks = {0, 0, 0}, shininess = 1, two_sided = true}
    return materials[index]
end

local function node_of(p)
    local node = p.combine and p.combine(p) or p.what.make(material(p.colour))
    if p.scale then node:scale(p.scale[1], p.scale[2], p.scale[3]) end
    if p.turn then node:rotate('x', p.turn[1]):rotate('y', p.turn[2]):rotate('z', p.turn[3]) end
    if p.move then node:translate(p.move[1], p.move[2], p.move[3]) end
    return node
end

local function sdl_of(p)
    local after = p.colour and not p.unseen and ' pigment{rgb' .. v(COLOURS[p.colour]) .. '}' or ''
    if p.scale then after = after .. ' scale' .. v(p.scale) end
    if p.turn then after = after .. ' rotate' .. v(p.turn) end
    if p.move then after = after .. ' translate' .. v(p.move) end
    local sdl = p.combine and p.sdl(p) or p.what.sdl
    return (sdl:gsub('%%s', function() return after end))
end

local function combination(word, join)
    return function(...)
        local parts = {...}
        return {
            combine = function()
                local nodes = {}
                for k, part in ipairs(parts) do nodes[k] = node_of(part) end
                return join(table.unpack(nodes))
            end,
            sdl = function()
                local words = {}
                for k, part in ipairs(parts) do words[k] = sdl_of(part) end
                return word .. '{' .. table.concat(words, '\n') .. ' %s}'
            end,
        }
    end
end
local union, merge = combination('union', gr.union), combination('merge', gr.merge)
local difference, intersection = combination('difference', gr.difference), combination('intersection', gr.intersection)
local function group(...) return combination('union', function(...) return gr.node {children = {...}} end)(...) end
local function inverse(part)
    return {
        combine = function() return gr.inverse(node_of(part)) end,
        sdl = function() return 'object{' .. sdl_of(part) .. ' inverse %s}' end,
    }
end
-- The second solid is invisible: POV-Ray uses no colour for it.
local function clipped(part, by)
    by.unseen = true
    return {
        combine = function() return gr.clipped_by(node_of(part), node_of(by)) end,
        sdl = function() return 'object{' .. sdl_of(part) .. ' clipped_by{' .. sdl_of(by) .. '} %s}' end,
    }
end
local function bounded(part, by)
    by.unseen = true
    return {
        combine = function() return gr.bounded_by(node_of(part), node_of(by)) end,
        sdl = function() return 'object{' .. sdl_of(part) .. ' bounded_by{' .. sdl_of(by) .. '} %s}' end,
    }
end
local function with(p, scale, turn, move)
    p.scale, p.turn, p.move = scale, turn, move
    return p
end

-- --- the shapes ---

local sphere = thing(function(m) return gr.sphere(m) end, 'sphere{0,1 %s}')
local box = thing(function(m) return gr.box {min = {-1, -0.7, -0.5}, max = {0.8, 0.9, 0.6}, material = m} end,
    'box{<-1,-.7,-.5>,<.8,.9,.6> %s}')
local cube = thing(function(m) return gr.box {min = {-1, -1, -1}, max = {1, 1, 1}, material = m} end, 'box{-1,1 %s}')
local ellipsoid = thing(function(m) return gr.ellipsoid {radii = {1.2, 0.6, 0.8}, material = m} end,
    'sphere{0,1 scale<1.2,.6,.8> %s}')
local plane = thing(function(m) return gr.plane {normal = {0.1, 1, 0.2}, distance = -0.8, material = m} end,
    'plane{<.1,1,.2>,-.8 %s}')
local disc = thing(function(m) return gr.disc {normal = {0, 1, 0}, radius = 1.3, inner = 0.5, material = m} end,
    'disc{0,y,1.3,.5 %s}')
local function cylinder(open)
    return thing(function(m) return gr.cylinder {from = {0, -0.9, 0.1}, to = {0.2, 1, 0}, radius = 0.7, open = open, material = m} end,
        'cylinder{<0,-.9,.1>,<.2,1,0>,.7 ' .. (open and 'open ' or '') .. '%s}')
end
local function cone(top, open)
    return thing(function(m)
        return gr.cone {from = {0, -0.9, 0}, from_radius = 1, to = {0, 1.1, 0.2}, radius = top, open = open, material = m}
    end, 'cone{<0,-.9,0>,1,<0,1.1,.2>,' .. top .. (open and ' open' or '') .. ' %s}')
end
local paraboloid = thing(function(m) return gr.paraboloid {radius = 1, height = 1.3, material = m} end,
    'intersection{quadric{<1,0,1>,0,<0,' .. -1 / 1.3 .. ',0>,0} plane{y,1.3} %s}')
local one_sheet = thing(function(m) return gr.hyperboloid {waist = 0.4, radius = 1, height = 1.1, material = m} end,
    'intersection{quadric{<1,' .. -(1 - 0.16) / 1.21 .. ',1>,0,0,-.16} plane{y,1.1} plane{-y,1.1} %s}')
local c = 0.81 / (1.44 / 0.09 - 1)
local two_sheets = thing(function(m) return gr.hyperboloid {gap = 0.3, radius = 0.9, height = 1.2, material = m} end,
    'intersection{quadric{<1,' .. -c / 0.09 .. ',1>,0,0,' .. c .. '} plane{y,1.2} plane{-y,1.2} %s}')
local quadric = thing(function(m)
    return gr.quadric {xx = 1, yy = -0.7, zz = 1.2, xy = 0.3, xz = -0.2, yz = 0.4, x = 0.1, y = 0.2, z = -0.1, constant = -0.3,
        min = {-1, -1, -1}, max = {1, 1, 1}, material = m}
end, 'intersection{quadric{<1,-.7,1.2>,<.3,-.2,.4>,<.1,.2,-.1>,-.3} box{-1,1} %s}')
local torus = thing(function(m) return gr.torus {major = 0.9, minor = 0.35, material = m} end, 'torus{.9,.35 sturm %s}')
local function superellipsoid(e, n)
    return thing(function(m) return gr.superellipsoid {e = e, n = n, material = m} end,
        'superellipsoid{<' .. e .. ',' .. n .. '> rotate x*90 %s}')
end
local profile = {{0, -1}, {0.8, -0.9}, {0.5, -0.2}, {1, 0.3}, {0.3, 0.8}, {0, 1.1}}
local lathe = thing(function(m) return gr.lathe {points = profile, material = m} end,
    'lathe{linear_spline ' .. #profile .. ',' .. pairs_of(profile) .. ' sturm %s}')
local curve = {{0.5, -1}, {1, -0.5}, {0.6, 0.1}, {0.9, 0.6}, {0.7, 1}}
local lathe_spline = thing(function(m) return gr.lathe {points = curve, spline = 'catmull-rom', open = true, material = m} end,
    'lathe{cubic_spline 7,<0,-1.5>,' .. pairs_of(curve) .. ',<.5,1.4> sturm %s}')
local star, hole = {}, {}
for k = 0, 9 do
    local r = k % 2 == 0 and 1.1 or 0.6
    star[k + 1] = {r * math.cos(k * math.pi / 5), r * math.sin(k * math.pi / 5)}
end
for k = 0, 3 do hole[k + 1] = {0.35 * math.cos(k * math.pi / 2), 0.35 * math.sin(k * math.pi / 2)} end
local function closed(points)
    local all = {table.unpack(points)}
    all[#all + 1] = points[1]
    return all
end
local prism = thing(function(m) return gr.prism {outline = star, from = -0.4, to = 0.5, material = m} end,
    'prism{linear_sweep linear_spline -.4,.5,11,' .. pairs_of(closed(star)) .. ' %s}')
local prism_hole = thing(function(m) return gr.prism {outline = star, holes = {hole}, from = -0.4, to = 0.5, material = m} end,
    'prism{linear_sweep linear_spline -.4,.5,16,' .. pairs_of(closed(star)) .. ',' .. pairs_of(closed(hole)) .. ' %s}')
local loop = {star[10], table.unpack(star)}
loop[12], loop[13] = star[1], star[2]
local prism_spline = thing(function(m) return gr.prism {outline = star, spline = 'catmull-rom', from = -0.4, to = 0.5, material = m} end,
    'prism{linear_sweep cubic_spline -.4,.5,13,' .. pairs_of(loop) .. ' sturm %s}')
local path, radii = {{-1, -0.8, 0}, {-0.3, 0.7, 0.4}, {0.5, -0.3, 0.2}, {1, 0.8, -0.3}}, {0.35, 0.25, 0.4, 0.2}
local function sweep(kind, spline)
    local words, all = {}, {}
    local function mirrored(a, b)
        return {2 * path[a][1] - path[b][1], 2 * path[a][2] - path[b][2], 2 * path[a][3] - path[b][3], 2 * radii[a] - radii[b]}
    end
    if spline == 'catmull-rom' then all[1] = mirrored(1, 2) end
    for k = 1, 4 do all[#all + 1] = {path[k][1], path[k][2], path[k][3], radii[k]} end
    if spline == 'catmull-rom' then all[6] = mirrored(4, 3) end
    for k, p in ipairs(all) do words[k] = v(p) .. ',' .. p[4] end
    return thing(function(m) return gr.sweep {points = path, radii = radii, spline = spline, material = m} end,
        'sphere_sweep{' .. kind .. ' ' .. #all .. ',' .. table.concat(words, ',') .. ' tolerance 1e-7 %s}')
end
local heights, facets = {}, {}
for row = 0, 8 do
    heights[row + 1] = {}
    for column = 0, 8 do heights[row + 1][column + 1] = 0.3 + 0.25 * math.sin(column * 0.9) * math.cos(row * 0.7) end
end
for row = 0, 7 do
    for column = 0, 7 do
        local function corner(i, j) return {i / 8, heights[j + 1][i + 1], j / 8} end
        local a, b, d, e = corner(column, row), corner(column + 1, row), corner(column, row + 1), corner(column + 1, row + 1)
        facets[#facets + 1] = 'triangle{' .. v(a) .. ',' .. v(b) .. ',' .. v(e) .. '} triangle{' .. v(a) .. ',' .. v(d) .. ',' .. v(e) .. '}'
    end
end
local height_field = thing(function(m) return gr.height_field {heights = heights, open = true, material = m} end,
    'mesh{' .. table.concat(facets, '\n') .. ' %s}')
local blob = thing(function(m)
    return gr.blob {spheres = {{-0.5, 0, 0, 0.9, 1}, {0.5, 0.2, 0.1, 0.8, 1.2}, {0, 0.5, 0.4, 0.6, -0.5}},
        cylinders = {{-0.6, -0.8, 0, 0.7, -0.6, 0.2, 0.5, 1}}, threshold = 0.4, material = m}
end, 'blob{threshold .4 sphere{<-.5,0,0>,.9,1} sphere{<.5,.2,.1>,.8,1.2} sphere{<0,.5,.4>,.6,-.5} ' ..
    'cylinder{<-.6,-.8,0>,<.7,-.6,.2>,.5,1} sturm %s}')
local net, net_words = {}, {}
for j = 0, 3 do
    for i = 0, 3 do
        local p = {i * 0.7 - 1.05, 0.6 * math.sin(2 * i + j) + 0.2 * i, j * 0.7 - 1.05}
        net[#net + 1], net_words[#net_words + 1] = p, v(p)
    end
end
local patch = thing(function(m) return gr.patch {points = net, tolerance = 1e-5, material = m} end,
    'bicubic_patch{type 1 flatness 1e-6 u_steps 6 v_steps 6 ' .. table.concat(net_words, ',') .. ' %s}')
local corners = {{1, 0, 0}, {-1, 0, 0}, {0, 1.3, 0}, {0, -1.1, 0}, {0, 0, 0.9}, {0, 0, -1}}
local faces, face_words = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}}, {}
for k, f in ipairs(faces) do
    face_words[k] = 'triangle{' .. v(corners[f[1] + 1]) .. ',' .. v(corners[f[2] + 1]) .. ',' .. v(corners[f[3] + 1]) .. '}'
end
local mesh = thing(function(m) return gr.mesh {verts = corners, faces = faces, material = m} end,
    'mesh{' .. table.concat(face_words, '\n') .. ' inside_vector<.1,1,.2> %s}')
local flat, flat_words = {}, {}
for k, p in ipairs(star) do flat[k] = {p[1], p[2], 0} end
for k, p in ipairs(closed(flat)) do flat_words[k] = v(p) end
local polygon = thing(function(m) return gr.polygon {points = flat, material = m} end,
    'polygon{11,' .. table.concat(flat_words, ',') .. ' %s}')

-- --- the scenes ---

local TURN, SIZE, MOVE = {20, 35, -15}, {1.2, 0.9, 1.1}, {0.2, -0.1, 0.3}
local function single(what) return placed(what, 1, SIZE, TURN, MOVE) end
local node_solid = difference(intersection(placed(cube, 1, {0.9, 0.9, 0.9}), placed(sphere, 2, {1.25, 1.25, 1.25})),
    placed(thing(function(m) return gr.cylinder {from = {-2, 0, 0}, to = {2, 0, 0}, radius = 0.5, material = m} end,
        'cylinder{-2*x,2*x,.5 %s}'), 3),
    placed(thing(function(m) return gr.cylinder {from = {0, -2, 0}, to = {0, 2, 0}, radius = 0.5, material = m} end,
        'cylinder{-2*y,2*y,.5 %s}'), 4))

local scenes = {
    {'sphere', single(sphere)}, {'box', single(box)}, {'ellipsoid', single(ellipsoid)},
    {'plane', group(placed(plane, 2), placed(sphere, 1, {0.7, 0.7, 0.7}))}, {'disc', single(disc)},
    {'cylinder', single(cylinder(false))}, {'open_cylinder', single(cylinder(true))}, {'cone', single(cone(0, false))},
    {'frustum', single(cone(0.4, false))}, {'open_frustum', single(cone(0.4, true))}, {'paraboloid', single(paraboloid)},
    {'hyperboloid_one_sheet', single(one_sheet)}, {'hyperboloid_two_sheets', single(two_sheets)}, {'quadric', single(quadric)},
    {'torus', single(torus)}, {'superellipsoid', single(superellipsoid(0.4, 0.7))}, {'superellipsoid_octahedron', single(superellipsoid(1.6, 1.4))},
    {'lathe', single(lathe)}, {'lathe_spline', single(lathe_spline)}, {'prism', single(prism)}, {'prism_with_hole', single(prism_hole)},
    {'prism_spline', single(prism_spline)}, {'sphere_sweep', single(sweep('linear_spline', 'linear'))},
    {'sphere_sweep_spline', single(sweep('cubic_spline', 'catmull-rom'))},
    {'height_field', placed(height_field, 1, {2.6, 1.5, 2.6}, {10, 20, 0}, {-1.2, -0.4, -1.2})}, {'blob', single(blob)},
    {'patch', single(patch)}, {'mesh', single(mesh)}, {'polygon', single(polygon)},
    {'union', with(union(placed(sphere, 1), placed(box, 2, nil, nil, {0.6, 0.2, 0.4})), SIZE, TURN, MOVE)},
    {'difference', with(difference(placed(cube, 1), placed(sphere, 2, {1.2, 1.2, 1.2}), placed(cylinder(false), 3, {0.6, 3, 0.6})), SIZE, TURN, MOVE)},
    {'intersection', with(intersection(placed(cube, 1), placed(sphere, 2, {1.3, 1.2, 1.3}), placed(torus, 3, {1, 3, 1})), SIZE, TURN, MOVE)},
    {'merge', with(merge(placed(torus, 1), placed(cone(0.4, false), 2), placed(mesh, 3, nil, {0, 30, 0}, {0.8, 0, 0})), SIZE, TURN, MOVE)},
    {'inverse', with(difference(placed(cube, 1), inverse(placed(sphere, 2, {1.25, 1.25, 1.25}))), SIZE, TURN, MOVE)},
    {'de_morgan', inverse(with(union(inverse(placed(cube, 1)), inverse(placed(torus, 2, {1.2, 2, 1.2}))), SIZE, TURN, MOVE))},
    {'clipped_by', with(clipped(placed(sphere, 1), placed(box, 2, nil, {0, 40, 0}, {0.3, 0, 0})), SIZE, TURN, MOVE)},
    {'clipped_by_inverse', with(clipped(placed(torus, 1), inverse(placed(cube, nil, {1, 1, 1}, nil, {0.9, 0.5, 0.9}))), SIZE, TURN, MOVE)},
    {'bounded_by', with(bounded(node_solid, placed(cube, 5)), SIZE, TURN, MOVE)},
    {'nested', difference(with(union(with(node_solid, {0.8, 0.8, 0.8}, {0, 20, 0}), placed(blob, 5, nil, nil, {0.7, 0.3, 0.3})), SIZE, TURN),
        placed(lathe, 6, {0.7, 0.7, 0.7}, {0, 0, 60}, {0.4, 0.6, 0.8}), placed(superellipsoid(0.4, 0.7), 7, {0.4, 0.9, 0.4}, {30, 0, 0}))},
}

if POV == nil then
    local only = tonumber(SCENE)
    for k, scene in ipairs(scenes) do
        if not only or only == k then
            local root = gr.node('root')
            root:add_child(node_of(scene[2]))
            gr.render {node = root, file = scene[1] .. '.pfm', width = WIDTH, height = HEIGHT, eye = EYE, target = {0, 0, 0}, fov = FOV,
                ambient = {1, 1, 1}, lights = {}, background = {0, 0, 0}, fog = gr.uniform_fog {density = DENSITY, colour = {0, 0, 0}}}
        end
    end
else
    local length = math.sqrt(EYE[1] ^ 2 + EYE[2] ^ 2 + EYE[3] ^ 2)
    local w = {-EYE[1] / length, -EYE[2] / length, -EYE[3] / length}
    local flat_length = math.sqrt(w[1] ^ 2 + w[3] ^ 2)
    local right = {-w[3] / flat_length, 0, w[1] / flat_length}
    local up = {right[2] * w[3] - right[3] * w[2], right[3] * w[1] - right[1] * w[3], right[1] * w[2] - right[2] * w[1]}
    local tall = 2 * math.tan(math.rad(FOV / 2))
    -- The scenes for POV-Ray, each after a line with its name.
    for _, scene in ipairs(scenes) do
        print('// SCENE ' .. scene[1])
        print('#version 3.7; global_settings{assumed_gamma 1 max_trace_level 2} #default{finish{ambient 1 diffuse 0}}')
        print('background{rgb 0} fog{fog_type 1 distance ' .. 1 / DENSITY .. ' color rgb 0}')
        print('camera{perspective location' .. v(EYE) .. ' direction' .. v(w) .. ' right ' .. tall * WIDTH / HEIGHT .. '*' .. v(right) ..
            ' up ' .. tall .. '*' .. v(up) .. '}')
        print(sdl_of(scene[2]))
    end
end
