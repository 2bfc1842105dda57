-- terrain: height tables for gr.height_field, and meshes of them.
-- Sources: A. Fournier, D. Fussell, L. Carpenter, "Computer Rendering of Stochastic Models", CACM 25(6), 1982 (midpoint
-- displacement, here in diamonds and squares); F. K. Musgrave, C. Kolb, R. Mace, "The Synthesis and Rendering of Eroded
-- Fractal Terrains", SIGGRAPH 1989 (sums of noise, ridges, thermal erosion); H. Beyer, "Implementation of a method for
-- hydraulic erosion", TU Muenchen 2015 (drops that transport soil).
-- Invariant: heights are rows of equally many numbers, heights[row][column], x along a row and z from row to row, as
-- for gr.height_field; no function changes its arguments.
--
--   local terrain = require 'terrain'
--   local land = terrain.noise {columns = 200, rows = 200, ridged = true, seed = 4}
--   land = terrain.erode_rain(land, {drops = 40000})
--   scene:add_child(gr.height_field {heights = terrain.fit(land, 0, 0.2), smooth = true, material = rock})

local check = require 'check'
local meshes = require 'meshes'
local noise = require 'noise'
local random = require 'random'

local M = {}

local floor, sqrt, max, min, abs = math.floor, math.sqrt, math.max, math.min, math.abs

local function checked(where, heights, least)
    least = least or 2
    check.list(where, 'heights', heights, least)
    local columns = type(heights[1]) == 'table' and #heights[1] or 0
    if columns < least then check.fail(where, ('heights[1] must be a table of at least %d numbers'):format(least)) end
    for j, row in ipairs(heights) do
        if type(row) ~= 'table' or #row ~= columns then
            check.fail(where, ('heights[%d] must have %d numbers as heights[1] has'):format(j, columns))
        end
        for i = 1, columns do
            if type(row[i]) ~= 'number' or row[i] ~= row[i] or abs(row[i]) == math.huge then
                check.fail(where, ('heights[%d][%d] must be a number'):format(j, i))
            end
        end
    end
    return columns, #heights
end

local function copy(heights)
    local out = {}
    for j, row in ipairs(heights) do out[j] = table.move(row, 1, #row, 1, {}) end
    return out
end

--- Midpoint displacement: (2^level + 1) rows and columns of about -1 to 1.
---@param options table?  level 1 to 10 (7), roughness: what is left of the displacement at half the distance, 0 smooth to
---  1 (0.5), seed (1), corners: four heights (0)
---@return number[][] heights
function M.midpoint(options)
    local where = 'terrain.midpoint'
    options = check.options(where, options, 'level roughness seed corners')
    local level = check.whole(where, 'level', options.level, 1, 10, 7)
    local roughness = check.number(where, 'roughness', options.roughness, 0, 1, 0.5)
    local corners = check.tuple(where, 'corners', options.corners, 4, { 0, 0, 0, 0 })
    local dice, n = random.new(check.whole(where, 'seed', options.seed, nil, nil, 1)), 1 << level
    local h = {}
    for j = 0, n do h[j] = {} end
    h[0][0], h[0][n], h[n][0], h[n][n] = corners[1], corners[2], corners[3], corners[4]
    local step, reach = n, 1.0
    while step > 1 do
        local half = step // 2
        for j = half, n, step do -- the middle of each square
            for i = half, n, step do
                h[j][i] = (h[j - half][i - half] + h[j - half][i + half] + h[j + half][i - half] + h[j + half][i + half]) / 4 +
                    reach * dice:range(-1, 1)
            end
        end
        for j = 0, n, half do -- the middle of each edge, between two corners and one or two middles
            for i = (j // half + 1) % 2 * half, n, step do
                local sum, count = 0, 0
                if j > 0 then sum, count = sum + h[j - half][i], count + 1 end
                if j < n then sum, count = sum + h[j + half][i], count + 1 end
                if i > 0 then sum, count = sum + h[j][i - half], count + 1 end
                if i < n then sum, count = sum + h[j][i + half], count + 1 end
                h[j][i] = sum / count + reach * dice:range(-1, 1)
            end
        end
        step, reach = half, reach * roughness
    end
    local out = {}
    for j = 0, n do out[j + 1] = table.move(h[j], 0, n, 1, {}) end
    return out
end

--- Sums of noise.
---@param options table?  columns, rows (128), size: of the largest hills in parts of a row's length (0.4), octaves (6),
---  gain: height of an octave relative to the previous one (0.5), lacunarity: ratio of frequencies (2), ridged: crests
---  instead of rounded hills (false), warp: amplitude of the domain warp (0), seed (1)
---@return number[][] heights  about -1 to 1; ridged 0 to 2
function M.noise(options)
    local where = 'terrain.noise'
    options = check.options(where, options, 'columns rows size octaves gain lacunarity ridged warp seed')
    local columns = check.whole(where, 'columns', options.columns, 2, 4096, 128)
    local rows = check.whole(where, 'rows', options.rows, 2, 4096, 128)
    local size = check.above(where, 'size', options.size, 0, 0.4)
    local octaves = check.whole(where, 'octaves', options.octaves, 1, 16, 6)
    local gain = check.number(where, 'gain', options.gain, 0, 1, 0.5)
    local lacunarity = check.number(where, 'lacunarity', options.lacunarity, 1, 8, 2)
    local warp = check.number(where, 'warp', options.warp, 0, 10, 0)
    local ridged = check.flag(where, 'ridged', options.ridged)
    local dice = random.new(check.whole(where, 'seed', options.seed, nil, nil, 1))
    local shifts = {}
    for k = 1, octaves + 2 do shifts[k] = { dice:range(0, 256), dice:range(0, 256), dice:range(0, 256) } end
    local value, out = noise.noise, {}
    for j = 1, rows do
        local row = {}
        for i = 1, columns do
            local x, z = (i - 1) / (columns - 1) / size, (j - 1) / (columns - 1) / size
            if warp > 0 then
                local a, b = shifts[octaves + 1], shifts[octaves + 2]
                x, z = x + warp * value(x + a[1], a[2], z + a[3]), z + warp * value(x + b[1], b[2], z + b[3])
            end
            local sum, scale, height, weight = 0, 1, 1, 1
            for k = 1, octaves do
                local s = shifts[k]
                local n = value(x * scale + s[1], s[2], z * scale + s[3])
                if ridged then
                    n = (1 - abs(n)) ^ 2 * weight
                    weight = min(1, 2 * n) -- fine crests only on coarse ones
                end
                sum, scale, height = sum + n * height, scale * lacunarity, height * gain
            end
            row[i] = sum
        end
        out[j] = row
    end
    return out
end

--- Heights from a function of the position.
---@param columns integer
---@param rows integer
---@param f fun(u: number, v: number, i: integer, j: integer): number  u, v 0..1 along and across
---@return number[][] heights
function M.of(columns, rows, f)
    check.whole('terrain.of', 'columns', columns, 2, 4096)
    check.whole('terrain.of', 'rows', rows, 2, 4096)
    check.callable('terrain.of', 'f', f)
    local out = {}
    for j = 1, rows do
        local row = {}
        for i = 1, columns do row[i] = f((i - 1) / (columns - 1), (j - 1) / (rows - 1), i, j) end
        out[j] = row
    end
    checked('terrain.of', out)
    return out
end

--- Applies a function to every height.
---@param heights number[][]
---@param f fun(height: number, u: number, v: number): number
---@return number[][] heights
function M.map(heights, f)
    local columns, rows = checked('terrain.map', heights)
    check.callable('terrain.map', 'f', f)
    return M.of(columns, rows, function(u, v, i, j) return f(heights[j][i], u, v) end)
end

--- The lowest and the highest.
function M.range(heights)
    checked('terrain.range', heights)
    local low, high = math.huge, -math.huge
    for _, row in ipairs(heights) do
        for _, h in ipairs(row) do low, high = min(low, h), max(high, h) end
    end
    return low, high
end

--- Scales heights so that the lowest is `low` and the highest `high`.
---@return number[][] heights
function M.fit(heights, low, high)
    check.number('terrain.fit', 'low', low)
    check.number('terrain.fit', 'high', high, low)
    local from, to = M.range(heights)
    local k = to > from and (high - low) / (to - from) or 0
    return M.map(heights, function(h) return low + (h - from) * k end)
end

--- Height between the points, bilinear.
---@param u number  0..1 along a row; clamped
---@param v number
---@return number
function M.at(heights, u, v)
    local columns, rows = #heights[1], #heights
    local x, y = min(max(u, 0), 1) * (columns - 1), min(max(v, 0), 1) * (rows - 1)
    local i, j = min(floor(x), columns - 2), min(floor(y), rows - 2)
    local s, t, a, b = x - i, y - j, heights[j + 1], heights[j + 2]
    return (a[i + 1] * (1 - s) + a[i + 2] * s) * (1 - t) + (b[i + 1] * (1 - s) + b[i + 2] * s) * t
end

--- Thermal erosion: material moves down where the slope between neighbours is too steep. The total is conserved.
---@param options table?  steps (30), talus: the difference between neighbours that holds (0.01), rate 0 to 0.5 (0.25)
---@return number[][] heights
function M.erode_slopes(heights, options)
    local where = 'terrain.erode_slopes'
    local columns, rows = checked(where, heights)
    options = check.options(where, options, 'steps talus rate')
    local steps = check.whole(where, 'steps', options.steps, 0, 10000, 30)
    local talus = check.number(where, 'talus', options.talus, 0, nil, 0.01)
    local rate = check.number(where, 'rate', options.rate, 0, 0.5, 0.25)
    local h = copy(heights)
    for _ = 1, steps do
        local change = {}
        for j = 1, rows do
            change[j] = {}
            for i = 1, columns do change[j][i] = 0 end
        end
        for j = 1, rows do
            for i = 1, columns do
                local here, most, total = h[j][i], 0, 0
                for d = 1, 4 do
                    local x, y = i + (d == 1 and 1 or d == 2 and -1 or 0), j + (d == 3 and 1 or d == 4 and -1 or 0)
                    local fall = h[y] and h[y][x] and here - h[y][x] - talus or 0
                    if fall > 0 then most, total = max(most, fall), total + fall end
                end
                if total > 0 then
                    local moved = rate * most
                    change[j][i] = change[j][i] - moved
                    for d = 1, 4 do
                        local x, y = i + (d == 1 and 1 or d == 2 and -1 or 0), j + (d == 3 and 1 or d == 4 and -1 or 0)
                        local fall = h[y] and h[y][x] and here - h[y][x] - talus or 0
                        if fall > 0 then change[y][x] = change[y][x] + moved * fall / total end
                    end
                end
            end
        end
        for j = 1, rows do
            for i = 1, columns do h[j][i] = h[j][i] + change[j][i] end
        end
    end
    return h
end

--- Hydraulic erosion: raindrops run downhill, take soil where they are fast and deposit it where they are slow: valleys
--- and fans.
---@param options table?  drops (20000), seed (1), inertia 0 to 1 (0.05), capacity (4), erosion 0 to 1 (0.3),
---  deposition 0 to 1 (0.3), evaporation 0 to 1 (0.02), life: steps of a drop (40), scale: unit of heights relative to
---  the distance of neighbours, which is 1 (heights of a sixth of the length of a row)
---@return number[][] heights
function M.erode_rain(heights, options)
    local where = 'terrain.erode_rain'
    local columns, rows = checked(where, heights, 4)
    options = check.options(where, options, 'drops seed inertia capacity erosion deposition evaporation life scale')
    local drops = check.whole(where, 'drops', options.drops, 0, 10000000, 20000)
    local inertia = check.number(where, 'inertia', options.inertia, 0, 1, 0.05)
    local capacity = check.above(where, 'capacity', options.capacity, 0, 4)
    local erosion = check.number(where, 'erosion', options.erosion, 0, 1, 0.3)
    local deposition = check.number(where, 'deposition', options.deposition, 0, 1, 0.3)
    local evaporation = check.number(where, 'evaporation', options.evaporation, 0, 1, 0.02)
    local life = check.whole(where, 'life', options.life, 1, 1000, 40)
    local low, high = M.range(heights)
    local scale = check.above(where, 'scale', options.scale, 0, high > low and columns / 6 / (high - low) or 1)
    local dice = random.new(check.whole(where, 'seed', options.seed, nil, nil, 1))
    local h = {}
    for j, row in ipairs(heights) do
        h[j] = {}
        for i, y in ipairs(row) do h[j][i] = y * scale end
    end
    for _ = 1, drops do
        local x, y = dice:range(1, columns - 1), dice:range(1, rows - 1)
        local dx, dy, speed, water, soil = 0, 0, 1, 1, 0
        for _ = 1, life do
            local i, j = floor(x), floor(y)
            local s, t, a, b = x - i, y - j, h[j], h[j + 1]
            local h00, h10, h01, h11 = a[i], a[i + 1], b[i], b[i + 1]
            local here = (h00 * (1 - s) + h10 * s) * (1 - t) + (h01 * (1 - s) + h11 * s) * t
            local gx, gy = (h10 - h00) * (1 - t) + (h11 - h01) * t, (h01 - h00) * (1 - s) + (h11 - h10) * s
            dx, dy = dx * inertia - gx * (1 - inertia), dy * inertia - gy * (1 - inertia)
            local length = sqrt(dx * dx + dy * dy)
            if length < 1e-9 then break end
            dx, dy = dx / length, dy / length
            x, y = x + dx, y + dy
            if x < 1 or y < 1 or x >= columns or y >= rows then break end
            local ni, nj = floor(x), floor(y)
            local ns, nt, na, nb = x - ni, y - nj, h[nj], h[nj + 1]
            local there = (na[ni] * (1 - ns) + na[ni + 1] * ns) * (1 - nt) + (nb[ni] * (1 - ns) + nb[ni + 1] * ns) * nt
            local rise = there - here
            local holds, gives = max(-rise, 0.01) * speed * water * capacity, nil
            if rise > 0 then gives = min(rise, soil)
            elseif soil > holds then gives = (soil - holds) * deposition
            else gives = -min((holds - soil) * erosion, -rise) end
            -- the four corners around the drop's previous position share the deposited or eroded soil
            soil = soil - gives
            a[i], a[i + 1] = h00 + gives * (1 - s) * (1 - t), h10 + gives * s * (1 - t)
            b[i], b[i + 1] = h01 + gives * (1 - s) * t, h11 + gives * s * t
            speed = sqrt(max(0, speed * speed - rise))
            water = water * (1 - evaporation)
        end
    end
    for j, row in ipairs(h) do
        for i, y in ipairs(row) do row[i] = y / scale end
    end
    return h
end

--- The terrain as a mesh over a rectangle centred at the origin, with vertex normals; a closed one can be an operand of
--- CSG.
---@param heights number[][]
---@param options table?  width, depth: along x and z (1, 1), bottom: closes it with sides down to this height
---@return number[][] verts
---@return number[][] normals
---@return integer[][] faces
---@return integer[][] face_normals
function M.mesh(heights, options)
    local where = 'terrain.mesh'
    local columns, rows = checked(where, heights)
    options = check.options(where, options, 'width depth bottom')
    local width = check.above(where, 'width', options.width, 0, 1)
    local depth = check.above(where, 'depth', options.depth, 0, 1)
    local mesh = meshes.net(rows - 1, columns - 1, function(j, i)
        return (i / (columns - 1) - 0.5) * width, heights[j + 1][i + 1], (j / (rows - 1) - 0.5) * depth
    end)
    -- the net's normals point to (step along a row) x (step from row to row), which is down
    mesh = meshes.flip(mesh)
    if not options.bottom then return mesh[1], mesh[2], mesh[3], mesh[4] end
    local bottom = check.number(where, 'bottom', options.bottom, nil, (M.range(heights)))
    local verts, normals, faces, face_normals = mesh[1], mesh[2], mesh[3], table.move(mesh[4], 1, #mesh[4], 1, {})
    -- the rim, counter-clockwise seen from above (-z is up there)
    local rim = {}
    for i = 0, columns - 2 do rim[#rim + 1] = { (rows - 1) * columns + i, 3 } end
    for j = rows - 1, 1, -1 do rim[#rim + 1] = { j * columns + columns - 1, 1 } end
    for i = columns - 1, 1, -1 do rim[#rim + 1] = { i, 4 } end
    for j = 0, rows - 2 do rim[#rim + 1] = { j * columns, 2 } end
    local first_normal, base, floor_face = #normals, #verts, {}
    for _, n in ipairs { { 1, 0, 0 }, { -1, 0, 0 }, { 0, 0, 1 }, { 0, 0, -1 }, { 0, -1, 0 } } do normals[#normals + 1] = n end
    for k, item in ipairs(rim) do
        local p = verts[item[1] + 1]
        verts[base + k] = { p[1], bottom, p[3] }
        local n, next_k = first_normal + item[2] - 1, k % #rim
        faces[#faces + 1] = { base + k - 1, base + next_k, rim[next_k + 1][1], item[1] }
        face_normals[#face_normals + 1] = { n, n, n, n }
        floor_face[#rim + 1 - k] = base + k - 1
    end
    faces[#faces + 1] = floor_face
    local down = {}
    for k = 1, #rim do down[k] = first_normal + 4 end
    face_normals[#face_normals + 1] = down
    return verts, normals, faces, face_normals
end

--- Splits the faces of a mesh into groups with a material each: grass where it is flat, rock where it is steep, snow
--- above.
---@param verts number[][]
---@param normals number[][]
---@param faces integer[][]
---@param choose fun(x: number, y: number, z: number, up: number): any  the group, from the middle of a face and the y of
---  its normal; nil leaves the face out
---@return table<any, table> groups  for each group a mesh { verts, normals, faces, faces }
function M.split(verts, normals, faces, choose)
    check.points('terrain.split', 'verts', verts, 3)
    check.points('terrain.split', 'normals', normals, 3)
    check.faces('terrain.split', 'faces', faces, #verts)
    check.callable('terrain.split', 'choose', choose)
    local groups, numbers = {}, {}
    for _, face in ipairs(faces) do
        local x, y, z, up, n = 0, 0, 0, 0, #face
        for _, index in ipairs(face) do
            local p = verts[index + 1]
            x, y, z, up = x + p[1] / n, y + p[2] / n, z + p[3] / n, up + normals[index + 1][2] / n
        end
        local key = choose(x, y, z, up)
        if key ~= nil then
            local group, number = groups[key], numbers[key]
            if not group then
                group, number = { {}, {}, {} }, {}
                group[4] = group[3]
                groups[key], numbers[key] = group, number
            end
            local moved = {}
            for k, index in ipairs(face) do
                if not number[index] then
                    group[1][#group[1] + 1], group[2][#group[2] + 1] = verts[index + 1], normals[index + 1]
                    number[index] = #group[1] - 1
                end
                moved[k] = number[index]
            end
            group[3][#group[3] + 1] = moved
        end
    end
    return groups
end

return M
