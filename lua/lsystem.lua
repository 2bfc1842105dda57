-- lsystem: words that grow by rules, and a turtle that interprets them in space.
-- Source: P. Prusinkiewicz, A. Lindenmayer, "The Algorithmic Beauty of Plants", 1990: chapter 1 (rules, brackets, the
-- turtle's letters), 1.7 (random rules), 1.10 (letters with parameters), 2.3 (tropism).
-- A word is a string of one-letter symbols with optional numbers in parentheses: F(1.5)[+(30)A(2,0.1)].
-- A rule gives the replacement of a letter: a string; a list of {weight, string}, of which one is chosen at random; or
-- a function of the letter's numbers that returns a string (or nil: no change).
--
-- The turtle first faces up (+y). F(l) moves and draws, f(l) only moves; +(a) -(a) turn left and right, &(a) ^(a) pitch
-- down and up, \(a) /(a) roll left and right, | turns by 180 degrees; $ rolls until its left is horizontal; [ ] save
-- and restore the state; !(w) sets the radius, ! alone reduces it; ;(k) sets the colour, ; alone increments it; ~(s)
-- adds a leaf of size s; { } draw a polygon with a corner at each dot. Other letters are ignored.
--
--   local lsystem = require 'lsystem'
--   local word = lsystem.grow('A', {A = 'F[&~][/(120)&~]/(137.5)A'}, 8)
--   local plant = lsystem.walk(word, {angle = 40, length = 0.2, radius = 0.02})
--   scene:add_child(gr.vn_mesh(bark, lsystem.mesh(plant)))
--   for _, leaf in ipairs(plant.leaves) do ... leaf.position, leaf.heading, leaf.left, leaf.up, leaf.size end

local check = require 'check'
local lathe = require 'lathe'
local random = require 'random'
local sweep = require 'sweep'

local M = {}

--- Iterates over letters and their numbers: calls f(letter, numbers or nil, text) for each.
local function each(where, word, f)
    local at, size = 1, #word
    while at <= size do
        local letter = word:sub(at, at)
        if word:sub(at + 1, at + 1) == '(' then
            local close = word:find(')', at + 2, true)
            if not close then check.fail(where, ('a parenthesis is not closed at letter %d'):format(at + 1)) end
            local numbers = {}
            for text in word:sub(at + 2, close - 1):gmatch '[^,]+' do
                local number = tonumber(text)
                if not number then check.fail(where, ("'%s' is not a number at letter %d"):format(text:sub(1, 30), at)) end
                numbers[#numbers + 1] = number
            end
            f(letter, numbers, word:sub(at, close))
            at = close + 1
        else
            f(letter, nil, letter)
            at = at + 1
        end
    end
end

--- Applies the rules to every letter at once, several times.
---@param axiom string
---@param rules table<string, string|table|function>
---@param times integer  0 to 100
---@param options table?  seed (1), limit: the longest word allowed (4000000 letters)
---@return string word
function M.grow(axiom, rules, times, options)
    local where = 'lsystem.grow'
    check.text(where, 'axiom', axiom)
    check.table(where, 'rules', rules)
    check.whole(where, 'times', times, 0, 100)
    options = check.options(where, options, 'seed limit')
    local dice = random.new(check.whole(where, 'seed', options.seed, nil, nil, 1))
    local limit = check.whole(where, 'limit', options.limit, 1, 100000000, 4000000)
    local plain, totals = true, {}
    for letter, rule in pairs(rules) do
        if type(letter) ~= 'string' or #letter ~= 1 then
            check.fail(where, ("rules are for single letters, not for '%s'"):format(tostring(letter):sub(1, 30)))
        end
        plain = plain and type(rule) == 'string'
        if type(rule) == 'table' then
            local total = 0
            for k, choice in ipairs(rule) do
                if type(choice) ~= 'table' or type(choice[1]) ~= 'number' or type(choice[2]) ~= 'string' then
                    check.fail(where, ("choice %d of the rule for %s must be {weight, string}"):format(k, letter))
                end
                total = total + choice[1]
            end
            if not (total > 0) then check.fail(where, ('the weights of the rule for %s must add up to more than 0'):format(letter)) end
            totals[letter] = total
        elseif type(rule) ~= 'string' and type(rule) ~= 'function' then
            check.fail(where, ('the rule for %s must be a string, a list of choices or a function'):format(letter))
        end
    end
    local word = axiom
    for _ = 1, times do
        if plain and not word:find('(', 1, true) then
            word = word:gsub('.', rules) -- the common case, in one call
        else
            local out, size = {}, 0
            each(where, word, function(letter, numbers, text)
                local rule, new = rules[letter], text
                if type(rule) == 'string' then
                    new = rule
                elseif type(rule) == 'function' then
                    new = rule(table.unpack(numbers or {})) or text
                    if type(new) ~= 'string' then check.fail(where, ('the rule for %s must return a string'):format(letter)) end
                elseif rule then
                    local chance = dice:number() * totals[letter]
                    for _, choice in ipairs(rule) do
                        new, chance = choice[2], chance - choice[1]
                        if chance < 0 then break end
                    end
                end
                size = size + #new
                if size > limit then check.fail(where, ('the word grows beyond %d letters'):format(limit)) end
                out[#out + 1] = new
            end)
            word = table.concat(out)
        end
        if #word > limit then check.fail(where, ('the word grows beyond %d letters'):format(limit)) end
    end
    return word
end

local function turn(a, b, degrees) -- rotates the frame's vectors a and b in their plane, from a to b
    local c, s = math.cos(math.rad(degrees)), math.sin(math.rad(degrees))
    return { a[1] * c + b[1] * s, a[2] * c + b[2] * s, a[3] * c + b[3] * s },
        { b[1] * c - a[1] * s, b[2] * c - a[2] * s, b[3] * c - a[3] * s }
end

local function cross(a, b)
    return { a[2] * b[3] - a[3] * b[2], a[3] * b[1] - a[1] * b[3], a[1] * b[2] - a[2] * b[1] }
end

local function unit(a)
    local length = math.sqrt(a[1] ^ 2 + a[2] ^ 2 + a[3] ^ 2)
    return { a[1] / length, a[2] / length, a[3] / length }
end

--- Bends the heading towards a direction (tropism), by its strength times the sine between them.
local function bend(t, to, strength)
    local axis = cross(t.heading, to)
    local sine = math.sqrt(axis[1] ^ 2 + axis[2] ^ 2 + axis[3] ^ 2)
    if sine < 1e-12 then return end
    axis = { axis[1] / sine, axis[2] / sine, axis[3] / sine }
    local c, s = math.cos(strength * sine), math.sin(strength * sine)
    for _, name in ipairs { 'heading', 'left', 'up' } do
        local v = t[name]
        local w, along = cross(axis, v), (axis[1] * v[1] + axis[2] * v[2] + axis[3] * v[3]) * (1 - c)
        t[name] = { v[1] * c + w[1] * s + axis[1] * along, v[2] * c + w[2] * s + axis[2] * along,
                    v[3] * c + w[3] * s + axis[3] * along }
    end
end

--- Interprets a word with the turtle.
---@param word string
---@param options table?  angle: degrees of a turn without number (90), length of a step (1), radius of what is drawn
---  (0.05), thinner: factor of ! (0.7), leaf: size of ~ (1), tropism: {direction, strength} per step, heading: {0, 1, 0},
---  jitter: turns vary by this many degrees in both directions (0), seed (1)
---@return table walk  branches: { points, radii, colour }, in the order they end; leaves: { position, heading, left, up,
---  size, colour }; polygons: { points, colour }; low, high: the bounding box; steps: the number of F
function M.walk(word, options)
    local where = 'lsystem.walk'
    check.text(where, 'word', word)
    options = check.options(where, options, 'angle length radius thinner leaf tropism heading jitter seed')
    local angle = check.number(where, 'angle', options.angle, nil, nil, 90)
    local length = check.number(where, 'length', options.length, nil, nil, 1)
    local thinner = check.above(where, 'thinner', options.thinner, 0, 0.7)
    local leaf = check.above(where, 'leaf', options.leaf, 0, 1)
    local jitter = check.number(where, 'jitter', options.jitter, 0, nil, 0)
    local dice = random.new(check.whole(where, 'seed', options.seed, nil, nil, 1))
    local tropism = options.tropism
    if tropism ~= nil then
        check.table(where, 'tropism', tropism)
        tropism = { unit(check.tuple(where, 'tropism[1]', tropism[1], 3)), check.number(where, 'tropism[2]', tropism[2]) }
    end
    local heading = unit(check.tuple(where, 'heading', options.heading, 3, { 0, 1, 0 }))
    local help = math.abs(heading[3]) < 0.9 and { 0, 0, 1 } or { 1, 0, 0 }
    local left = unit(cross(help, heading))
    local t = { position = { 0, 0, 0 }, heading = heading, left = left, up = cross(heading, left),
                radius = check.above(where, 'radius', options.radius, 0, 0.05), colour = 1 }
    local walk = { branches = {}, leaves = {}, polygons = {}, steps = 0,
                   low = { 0, 0, 0 }, high = { 0, 0, 0 } }
    local stack, polygons, branch = {}, {}, nil

    local function finish()
        if branch and #branch.points > 1 then walk.branches[#walk.branches + 1] = branch end
        branch = nil
    end
    local function go(distance, draws)
        local p, h = t.position, t.heading
        if draws and not (branch and branch.colour == t.colour) then
            finish()
            branch = { points = { p }, radii = { t.radius }, colour = t.colour }
        end
        t.position = { p[1] + h[1] * distance, p[2] + h[2] * distance, p[3] + h[3] * distance }
        for k = 1, 3 do
            walk.low[k], walk.high[k] = math.min(walk.low[k], t.position[k]), math.max(walk.high[k], t.position[k])
        end
        if draws then
            if distance ~= 0 then
                branch.points[#branch.points + 1], branch.radii[#branch.radii + 1] = t.position, t.radius
            end
            walk.steps = walk.steps + 1
            if tropism then bend(t, tropism[1], tropism[2]) end
        else
            finish()
        end
    end
    local function degrees(numbers)
        local a = numbers and numbers[1] or angle
        return jitter > 0 and a + dice:range(-jitter, jitter) or a
    end
    local letters = {
        F = function(n) go(n and n[1] or length, true) end,
        f = function(n) go(n and n[1] or length, false) end,
        ['+'] = function(n) t.heading, t.left = turn(t.heading, t.left, degrees(n)) end,
        ['-'] = function(n) t.heading, t.left = turn(t.heading, t.left, -degrees(n)) end,
        ['^'] = function(n) t.heading, t.up = turn(t.heading, t.up, degrees(n)) end,
        ['&'] = function(n) t.heading, t.up = turn(t.heading, t.up, -degrees(n)) end,
        ['\\'] = function(n) t.left, t.up = turn(t.left, t.up, degrees(n)) end,
        ['/'] = function(n) t.left, t.up = turn(t.left, t.up, -degrees(n)) end,
        ['|'] = function() t.heading, t.left = turn(t.heading, t.left, 180) end,
        ['$'] = function()
            local level = cross({ 0, 1, 0 }, t.heading)
            if level[1] ^ 2 + level[2] ^ 2 + level[3] ^ 2 > 1e-18 then
                t.left = unit(level)
                t.up = cross(t.heading, t.left)
            end
        end,
        ['!'] = function(n)
            t.radius = n and n[1] or t.radius * thinner
            if not (t.radius >= 0) then check.fail(where, 'a radius must not be negative') end
        end,
        [';'] = function(n) t.colour = n and n[1] or t.colour + 1 end,
        ['~'] = function(n)
            walk.leaves[#walk.leaves + 1] = { position = t.position, heading = t.heading, left = t.left, up = t.up,
                                              size = n and n[1] or leaf, colour = t.colour }
        end,
        ['['] = function()
            stack[#stack + 1] = { t, branch }
            local new = {}
            for key, value in pairs(t) do new[key] = value end
            t, branch = new, nil
        end,
        [']'] = function()
            local top = table.remove(stack)
            if not top then check.fail(where, 'there is a ] without [') end
            finish()
            t, branch = top[1], top[2]
        end,
        ['{'] = function() polygons[#polygons + 1] = { points = {}, colour = t.colour } end,
        ['.'] = function()
            local polygon = polygons[#polygons]
            if polygon then polygon.points[#polygon.points + 1] = t.position end
        end,
        ['}'] = function()
            local polygon = table.remove(polygons)
            if not polygon then check.fail(where, 'there is a } without {') end
            if #polygon.points >= 3 then walk.polygons[#walk.polygons + 1] = polygon end
        end,
    }
    each(where, word, function(letter, numbers)
        local act = letters[letter]
        if act then act(numbers) end
    end)
    if #stack > 0 then check.fail(where, ('%d of the [ have no ]'):format(#stack)) end
    finish()
    return walk
end

--- The branches as one mesh of closed tubes with vertex normals.
---@param walk table
---@param options table?  around: corners of a tube (8), smooth: pieces of the spline through the points of a branch (1:
---  straight), colour: only branches of this one, round: tips end in a point (true)
---@return number[][] verts
---@return number[][] normals
---@return integer[][] faces
---@return integer[][] face_normals
function M.mesh(walk, options)
    local where = 'lsystem.mesh'
    check.table(where, 'walk', walk)
    check.table(where, 'walk.branches', walk.branches)
    options = check.options(where, options, 'around smooth colour round')
    local around = check.whole(where, 'around', options.around, 3, 256, 8)
    local pieces = check.whole(where, 'smooth', options.smooth, 1, 64, 1)
    local pointed = check.flag(where, 'round', options.round, true)
    local verts, normals, faces = {}, {}, {}
    local circle = {}
    for k = 0, around - 1 do
        circle[k + 1] = { math.cos(2 * math.pi * k / around), math.sin(2 * math.pi * k / around) }
    end
    local function ring(p, frame, radius, lean)
        local side, up, ahead, base = frame[2], frame[3], frame[1], #verts
        local flat = 1 / math.sqrt(1 + lean * lean)
        for _, c in ipairs(circle) do
            local d = { side[1] * c[1] + up[1] * c[2], side[2] * c[1] + up[2] * c[2], side[3] * c[1] + up[3] * c[2] }
            verts[#verts + 1] = { p[1] + radius * d[1], p[2] + radius * d[2], p[3] + radius * d[3] }
            normals[#normals + 1] = { (d[1] + lean * ahead[1]) * flat, (d[2] + lean * ahead[2]) * flat, (d[3] + lean * ahead[3]) * flat }
        end
        return base
    end
    for _, branch in ipairs(walk.branches) do
        if options.colour == nil or branch.colour == options.colour then
            local with_radius = {}
            for k, p in ipairs(branch.points) do with_radius[k] = { p[1], p[2], p[3], branch.radii[k] } end
            local path = pieces > 1 and #with_radius > 2 and lathe.spline(with_radius, pieces) or with_radius
            local frames, count, before = sweep.frames(path), #path, nil
            for k, p in ipairs(path) do
                local a, b = path[math.max(k - 1, 1)], path[math.min(k + 1, count)]
                local run = math.sqrt((b[1] - a[1]) ^ 2 + (b[2] - a[2]) ^ 2 + (b[3] - a[3]) ^ 2)
                local base = ring(p, frames[k], math.max(p[4], 1e-6), run > 0 and (a[4] - b[4]) / run or 0)
                for j = 0, around - 1 do
                    if before then
                        local next_j = (j + 1) % around
                        faces[#faces + 1] = { before + j, before + next_j, base + next_j, base + j }
                    end
                end
                if k == 1 or k == count then -- the ends: flat at the root, a point at the tip
                    local h, out = frames[k][1], k == 1 and -1 or 1
                    local far = k == count and pointed and p[4] or 0
                    verts[#verts + 1] = { p[1] + h[1] * far, p[2] + h[2] * far, p[3] + h[3] * far }
                    normals[#normals + 1] = { h[1] * out, h[2] * out, h[3] * out }
                    local tip = #verts - 1
                    for j = 0, around - 1 do
                        local next_j = (j + 1) % around
                        faces[#faces + 1] = k == 1 and { base + next_j, base + j, tip } or { base + j, base + next_j, tip }
                    end
                end
                before = base
            end
        end
    end
    return verts, normals, faces, faces
end

--- The branches as sphere sweeps: exact, round at corners and ends.
---@param walk table
---@param material gr.material|gr.material[]  one, or one for each colour
---@param spline? 'linear'|'catmull-rom'
---@return gr.node
function M.sweeps(walk, material, spline)
    local where = 'lsystem.sweeps'
    check.table(where, 'walk', walk)
    spline = check.word(where, 'spline', spline, 'linear catmull-rom', 'linear')
    local node = gr.node 'walk'
    for _, branch in ipairs(walk.branches) do
        local look = material
        if type(material) == 'table' then look = material[(branch.colour - 1) % #material + 1] end
        node:add_child(gr.sweep { name = 'branch', points = branch.points, radii = branch.radii, spline = spline, material = look })
    end
    return node
end

--- A mesh of all leaves: a small mesh at each position, its x along the turtle's left, its y along the heading and its
--- z along its up.
---@param walk table
---@param leaf table  a mesh { verts, normals, faces, face_normals } about as large as 1, or nil for a simple blade
---@param colour any?  only leaves of this one
---@return number[][] verts
---@return number[][] normals
---@return integer[][] faces
---@return integer[][] face_normals
function M.leaves(walk, leaf, colour)
    local where = 'lsystem.leaves'
    check.table(where, 'walk', walk)
    leaf = leaf or M.blade()
    check.points(where, 'leaf[1]', leaf[1], 3)
    check.points(where, 'leaf[2]', leaf[2], 3)
    local verts, normals, faces, face_normals = {}, {}, {}, {}
    for _, place in ipairs(walk.leaves) do
        if colour == nil or place.colour == colour then
            local p, x, y, z, s = place.position, place.left, place.heading, place.up, place.size
            local base, normal_base = #verts, #normals
            for k, q in ipairs(leaf[1]) do
                verts[base + k] = { p[1] + s * (x[1] * q[1] + y[1] * q[2] + z[1] * q[3]),
                                    p[2] + s * (x[2] * q[1] + y[2] * q[2] + z[2] * q[3]),
                                    p[3] + s * (x[3] * q[1] + y[3] * q[2] + z[3] * q[3]) }
            end
            for k, q in ipairs(leaf[2]) do
                normals[normal_base + k] = { x[1] * q[1] + y[1] * q[2] + z[1] * q[3], x[2] * q[1] + y[2] * q[2] + z[2] * q[3],
                                             x[3] * q[1] + y[3] * q[2] + z[3] * q[3] }
            end
            for f, face in ipairs(leaf[3]) do
                local a, b = {}, {}
                for k, index in ipairs(face) do a[k], b[k] = index + base, leaf[4][f][k] + normal_base end
                faces[#faces + 1], face_normals[#face_normals + 1] = a, b
            end
        end
    end
    return verts, normals, faces, face_normals
end

--- A leaf blade from the origin along y, of length 1, bent along its rib. Use a material with two_sided.
---@param width number?  default 0.5
---@param rows integer?  default 5
---@return table mesh
function M.blade(width, rows)
    width = check.above('lsystem.blade', 'width', width, 0, 0.5)
    rows = check.whole('lsystem.blade', 'rows', rows, 2, 100, 5)
    local meshes = require 'meshes'
    return meshes.net(rows, 2, function(i, j)
        local t = i / rows
        local half = width / 2 * math.sin(math.pi * t ^ 0.8) * (1 - 0.3 * t)
        local x = (1 - j) * half
        return x, t, math.abs(x) * 0.5 - 0.22 * t * t
    end)
end

--- Examples. Each has axiom, rules, times and the options of walk.
M.examples = {
    -- Prusinkiewicz and Lindenmayer, figure 1.19: the three-dimensional Hilbert curve, 8^n - 1 steps
    hilbert = {
        axiom = 'A', times = 3, angle = 90,
        rules = {
            A = 'B-F+CFC+F-D&F^D-F+&&CFC+F+B//', B = 'A&F^CFB^F^D^^-F-D^|F^B|FC^F^A//',
            C = '|D^|F^B-F+C^F^A&&FA&F^C+F+B^F^D//', D = '|CFB-F+B|FA&F^A&&FB-F+B|FC//',
        },
    },
    -- figure 1.24 f: a herb in the plane
    herb = { axiom = 'X', times = 5, angle = 22.5, rules = { X = 'F-[[X]+X]+F[+FX]-X', F = 'FF' } },
    -- figure 1.25: a bush
    bush = {
        axiom = 'A', times = 7, angle = 22.5, rules = { A = '[&FL!A]/////[&FL!A]///////[&FL!A]', F = 'S/////F', S = 'FL', L = '[~]' },
    },
    -- figure 2.6: a tree after Honda, with the ratios of its first picture
    tree = {
        axiom = '!(0.1)A(1,0.1)', times = 8, angle = 45,
        rules = {
            A = function(l, w)
                return ('!(%.6g)F(%.6g)[&(45)B(%.6g,%.6g)]/(137.5)A(%.6g,%.6g)'):format(w, l, l * 0.6, w * 0.707, l * 0.9, w * 0.707)
            end,
            B = function(l, w)
                return ('!(%.6g)F(%.6g)[-(45)$C(%.6g,%.6g)]C(%.6g,%.6g)'):format(w, l, l * 0.6, w * 0.707, l * 0.9, w * 0.707)
            end,
            C = function(l, w)
                return ('!(%.6g)F(%.6g)[+(45)$B(%.6g,%.6g)]B(%.6g,%.6g)'):format(w, l, l * 0.6, w * 0.707, l * 0.9, w * 0.707)
            end,
        },
    },
    -- Koch's snowflake
    koch = { axiom = 'F--F--F', times = 4, angle = 60, rules = { F = 'F+F--F+F' } },
}

--- Grows one of lsystem.examples and interprets it.
---@param name string
---@param times integer?
---@param options table?  as for walk
---@return table walk
function M.example(name, times, options)
    local where = 'lsystem.example'
    check.word(where, 'name', name, 'hilbert herb bush tree koch')
    local example, all = M.examples[name], {}
    for key, value in pairs(options or {}) do all[key] = value end
    if all.angle == nil then all.angle = example.angle end
    return M.walk(M.grow(example.axiom, example.rules, check.whole(where, 'times', times, 0, 12, example.times), { limit = 20000000 }), all)
end

return M
