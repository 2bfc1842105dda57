-- Calls with --lenient whose arguments cannot be read, and handles of which there is too little (lenient.c). Arguments
-- are matched by type to the positional form that takes most of them, or by the letters of their names. Remaining
-- arguments are converted, missing ones get a default, values out of range the nearest one.
local rawget, rawlen, type, next, ipairs, tonumber = rawget, rawlen, type, next, ipairs, tonumber
local floor, abs, max, min, find, match = math.floor, math.abs, math.max, math.min, string.find, string.match
local sub, select, tostring = string.sub, select, tostring
local LIMIT, MATCHED, NESTED = 1e30, 24, 3
local functions -- of gr, even if the script has replaced them

-- Values in the form that a parameter wants: a number for a table and the reverse, tables with fields x, y, z or r, g,
-- b, one handle for a list of them, colours for materials. What has no sensible form becomes nil, and the parameter
-- gets its default.

local function is(value, wanted)
    local kind = handle(value)
    return kind == wanted or kind == 'ghost'
end

-- A number as a float: '3 cm' is one, the first of a table, and true.
local function number_of(value, depth)
    local kind, x = type(value), nil
    if kind == 'number' then x = value end
    if kind == 'boolean' then x = value and 1 or 0 end
    if kind == 'table' and (depth or 0) < NESTED then x = number_of(rawget(value, 1), (depth or 0) + 1) end
    if kind == 'string' then
        x = tonumber(value) or tonumber(match(value, '^%s*[+-]?%d*%.?%d*[eE][+-]?%d+') or
            match(value, '^%s*[+-]?%d*%.?%d*'))
    end
    return x and x - x == 0 and x + 0.0 or nil
end

-- The number of the range that is nearest. False: there is none.
local function into_range(p, x)
    x = max(-LIMIT, min(LIMIT, x))
    if p.kind == 'whole' then x = x // 1 end
    if p.not_zero then return x, x ~= 0 end
    if p.low == 0 and p.high == 0 then return x, true end
    if x < p.low or p.low_open and x <= p.low then return p.low, not p.low_open end
    if x > p.high or p.high_open and x >= p.high then return p.high, not p.high_open end
    return x, true
end

-- A ball of radius 0 draws nothing.
local function number(call, value, p)
    local x, inside = number_of(value), nil
    if not x then return nil end
    x, inside = into_range(p, x)
    if inside then return x end
    local has_extent = p.not_zero or p.low_open and x <= p.low
    call.nothing = call.nothing or call.f.result == 'node' and has_extent
end

-- '#c08040'.
local function colour_of(value)
    if type(value) ~= 'string' then return nil end
    local r, g, b = match(value, '^#(%x%x)(%x%x)(%x%x)$')
    return r and {tonumber(r, 16) / 255, tonumber(g, 16) / 255, tonumber(b, 16) / 255}
end

local components = {{'x', 'r'}, {'y', 'g'}, {'z', 'b'}, {'w', 'a'}}

-- By its index, or by its name; quaternions begin with w.
local function component(value, k, count)
    local pair, entry = components[count == 4 and (k + 2) % 4 + 1 or k], rawget(value, k)
    if entry == nil and pair then entry = rawget(value, pair[1]) end
    if entry == nil and pair then entry = rawget(value, pair[2]) end
    return entry
end

local function tuple(call, value, p, count)
    local colour, x, out = colour_of(value), nil, {}
    if type(value) == 'table' then
        local first = rawget(value, 1)
        if type(first) == 'table' and rawlen(first) >= count then value = first end -- {{x, y, z}}
    elseif not colour then
        x = number_of(value)
        if not x then return nil end
    end
    for k = 1, count do
        local n, inside = colour and colour[(k - 1) % 3 + 1] or x, nil
        if type(value) == 'table' then n = number_of(component(value, k, count)) or 0.0 end
        n, inside = into_range(p, n)
        call.nothing = call.nothing or not inside and call.f.result == 'node'
        out[k] = inside and n or 1.0
    end
    return out
end

-- A list of the handles of that type: the value itself, or those in the table, also in tables in it.
local function list_of(value, wanted)
    local out, length = {}, 0
    if is(value, wanted) then return {value} end
    if type(value) ~= 'table' then return out end
    for k in next, value do
        if math.type(k) == 'integer' and k > length and k < 1000000 then length = k end
    end
    for k = 1, length do
        local entry = rawget(value, k)
        for i = 1, type(entry) == 'table' and rawlen(entry) or 0 do
            if is(rawget(entry, i), wanted) then out[#out + 1] = rawget(entry, i) end
        end
        if is(entry, wanted) then out[#out + 1] = entry end
    end
    return out
end

-- None is left out, since indices refer to them.
local function points(call, value, p, count)
    if type(value) ~= 'table' then return nil end
    local out = {}
    for k = 1, rawlen(value) do
        out[k] = tuple(call, rawget(value, k), p, count)
        for d = 1, out[k] and 0 or count do
            out[k] = out[k] or {}
            out[k][d] = 0.0
        end
    end
    return out
end

-- Faces with indices of vertices that exist.
local function faces(call, value, p)
    if type(value) ~= 'table' then return nil end
    local of = p.name == 'face_normals' and 'normals' or p.name == 'face_uvs' and 'uvs' or 'verts'
    local vertices, out = call.counts[of] or 0, {}
    for k = 1, rawlen(value) do
        local row, face = rawget(value, k), {}
        local corners = type(row) == 'table' and rawlen(row) or 0
        for i = 1, corners do
            local x = number_of(rawget(row, i))
            if x and x >= 0 and x < vertices then face[#face + 1] = floor(x) end
        end
        if #face >= 3 and #face == corners then out[#out + 1] = face end
    end
    return out
end

local function letters(text) return string.lower((string.gsub(text, '_', ''))) end

-- The word with the same letters, or that of the number.
local function choice(_, value, p)
    local words = {}
    for word in string.gmatch(p.choices or '', '[^ ]+') do words[#words + 1] = word end
    if p.kind == 'axis' and type(value) == 'table' then -- {0, 1, 0} is y
        local axis, most = 'x', 0
        for k = 1, 3 do
            local x = number_of(component(value, k, 3))
            if x and abs(x) > most then axis, most = sub('xyz', k, k), abs(x) end
        end
        return axis
    end
    if p.or_curve and type(value) == 'function' then return value end
    if type(value) == 'number' then return words[max(1, floor(min(100, value)))] or '' end
    if type(value) ~= 'string' then return nil end
    local axis = p.kind == 'axis' and match(value, '[xyzXYZ]')
    if axis then return string.lower(axis) end
    for _, word in ipairs(words) do
        if letters(word) == letters(value) then return word end
    end
end

local function plain(r) return functions.material{kd = r} end

local function itself(_, value) return value end
local function text(_, value) return (type(value) == 'string' or type(value) == 'number') and value or nil end
local function of_tuples(count) return function(call, value, p) return tuple(call, value, p, count) end end
local function of_points(count) return function(call, value, p) return points(call, value, p, count) end end
local function of_handles(wanted) return function(_, value) return list_of(value, wanted) end end

local conversions = {
    number = number, whole = number, text = text, file = text, output = text, choice = choice, axis = choice,
    point = of_tuples(3), direction = of_tuples(3), colour = of_tuples(3), triple = of_tuples(3), size = of_tuples(3),
    quaternion = of_tuples(4), interval = of_tuples(2), pair = of_tuples(2), points = of_points(3),
    pairs = of_points(2), stops = of_points(4), faces = faces, nodes = of_handles('node'), lights = of_handles('light'),
    boolean = function(_, value) return not not value and tonumber(value) ~= 0 end,
    background = function(call, value, p) return type(value) == 'table' and tuple(call, value, p, 3) or value end,
    -- A group of the nodes of a table.
    node = function(_, value)
        if is(value, 'node') then return value end
        local list = list_of(value, 'node')
        return #list > 1 and functions.node{children = list} or list[1]
    end,
    -- A colour becomes the kd of a material.
    material = function(_, value)
        if is(value, 'material') then return value end
        local is_tuple = type(value) == 'table' and type(rawget(value, 3)) == 'number'
        return (is_tuple or colour_of(value) or is(value, 'texture')) and plain(value) or nil
    end,
}

local function convert(call, value, p)
    if p.or_texture and (handle(value) == 'texture' or type(value) == 'function') then return value end
    return (conversions[p.kind] or itself)(call, value, p)
end

local function three(x) return {x, x, x} end

-- Of an argument that is missing.
local function default(f, p)
    local x = (f.owner == 'gr' or f.renders) and 1 or f.name == 'scale' and 1 or 0
    local kind, inside = p.kind, nil
    if kind == 'number' or kind == 'whole' then
        x, inside = into_range(p, f.renders and kind == 'whole' and 256 or x)
        return inside and x or 0.5 * (p.low + min(p.high, p.low + 1))
    elseif kind == 'point' then -- the camera of gr.render fits the scene
        return not f.renders and three(0) or nil
    elseif kind == 'triple' then
        return three(f.owner == 'gr' and 0 or x)
    elseif kind == 'direction' then
        return p.name == 'v1' and {1, 0, 0} or p.name == 'v2' and {0, 0, 1} or {0, 1, 0}
    elseif kind == 'colour' then
        return three(f.result == 'light' and 1 or 0.7)
    elseif kind == 'size' then
        return three(1)
    elseif kind == 'output' then
        return picture_name()
    elseif kind == 'choice' or kind == 'axis' then
        return match(p.choices or '', '^[^ ]*')
    elseif kind == 'file' or kind == 'image' then
        return 'missing'
    elseif kind == 'node' then
        return f.renders and root() or nil
    elseif kind == 'material' then
        return plain(three(0.7))
    elseif kind == 'nodes' or kind == 'lights' then
        return {}
    end
end

-- Matching. A form is a list of {parameter, optional}; taken[p] is the argument of its parameter p.

local entries = {}
for kind, words in next, {table = 'points faces pairs stops rows curves', userdata = 'nodes lights materials'} do
    for word in string.gmatch(words, '%a+') do entries[word] = kind end
end

-- How well the value fits, from 0 (not at all) to 3. Files have an ending: "cow.obj", "pictures/brick.png".
local function fit(value, p)
    local kind, is_string = p.kind, type(value) == 'string'
    if not resembles(p.row, value) then return 0 end
    if (kind == 'text' or kind == 'file' or kind == 'output' or kind == 'image') and (is_string or tonumber(value)) then
        if not is_string then return 1 end
        local ending = match(value, '^.+%.([^./ ]+)$')
        return not (ending and #ending > 1 and #ending < 6) and 2 or kind == 'text' and 1 or 3
    end
    if is_string and (kind == 'number' or kind == 'whole') then return 1 end
    if type(value) == 'number' and (kind == 'choice' or kind == 'axis') then return 1 end
    if type(value) ~= 'table' then return 2 end
    local first = type(rawget(value, 1))
    return first == (entries[kind] or 'number') and 3 or first == 'nil' and 2 or 1
end

-- In order, by the longest common subsequence by the sum of its fits; then the remaining arguments in any order; then
-- two arguments are exchanged where both fit better.
local function match_form(form, values, count)
    local fits, best, taken, used, score = {}, {}, {}, {}, 0
    for p = #form + 1, 1, -1 do
        fits[p], best[p] = {}, {}
        for a = count + 1, 1, -1 do
            local inside = p <= #form and a <= count
            local now = inside and fit(values[a], form[p].parameter) or 0
            local both = now > 0 and now + best[p + 1][a + 1] or 0
            fits[p][a], best[p][a] = now, inside and max(both, best[p + 1][a], best[p][a + 1]) or 0
        end
    end
    local function fits_at(p, a) return a and fits[p][a] or 0 end
    local p, a = 1, 1
    while p <= #form and a <= count do
        if fits[p][a] > 0 and best[p][a] == fits[p][a] + best[p + 1][a + 1] then
            taken[p], used[a], p, a = a, true, p + 1, a + 1
        elseif best[p][a] == best[p + 1][a] then
            p = p + 1
        else
            a = a + 1
        end
    end
    for p = 1, #form do
        for a = 1, count do
            if not taken[p] and not used[a] and fits[p][a] > 0 then taken[p], used[a] = a, true end
        end
    end
    for p = 1, #form do
        for q = p + 1, #form do
            local i, j = taken[p], taken[q]
            local better = fits_at(p, j) + fits_at(q, i) > fits_at(p, i) + fits_at(q, j)
            if better and (not j or fits_at(p, j) > 0) and (not i or fits_at(q, i) > 0) then
                taken[p], taken[q] = j, i
            end
        end
    end
    for p = 1, #form do
        score = score + fits_at(p, taken[p])
        if not taken[p] and not form[p].optional then score = score - 1 end
    end
    return {form = form, taken = taken, used = used, score = score}
end

local tuples = {point = 3, direction = 3, colour = 3, triple = 3, size = 3, quaternion = 4}

-- A table of the next unused numbers, at most `limit`; one stands for all.
local function loose_numbers(m, values, count, limit)
    local out = {}
    for a = 1, count do
        if #out < limit and not m.used[a] and type(values[a]) == 'number' then
            m.used[a], out[#out + 1] = true, values[a]
        end
    end
    if #out < 2 then return out[1] end
    return out
end

-- Without any table, three numbers stand for each: all numbers are taken again, in order.
local function free_loose_numbers(m, values, count)
    local numbers, has_tuple = 0, false
    for a = 1, count do
        if type(values[a]) == 'table' then return end
        numbers = numbers + (type(values[a]) == 'number' and 1 or 0)
    end
    for _, entry in ipairs(m.form) do has_tuple = has_tuple or tuples[entry.parameter.kind] end
    for p = 1, has_tuple and numbers >= 3 and #m.form or 0 do
        local a = m.taken[p]
        if a and type(values[a]) == 'number' then m.taken[p], m.used[a] = nil, nil end
    end
end

-- The first unused argument that can be converted, or nil.
local function convertible(call, m, values, count, p)
    local nothing = call.nothing
    for a = 1, p.kind == 'boolean' and 0 or count do
        local value = nil
        if not m.used[a] and values[a] ~= nil then value = convert(call, values[a], p) end
        if value ~= nil and not (type(value) == 'table' and rawlen(value) == 0) then
            m.used[a] = true
            return value
        end
    end
    call.nothing = nothing
end

local function name_positional(call, given, count)
    local f, named, values, best = call.f, {}, {}, nil
    local before = is_gr(given[1]) and 1 or 0 -- gr:sphere()
    count = min(count - before, MATCHED)
    for a = 1, count do values[a] = given[a + before] end
    for _, form in ipairs(f.forms) do
        local m = match_form(form, values, count)
        if not best or m.score > best.score then best = m end
    end
    if not best then return named end
    free_loose_numbers(best, values, count)
    for i, entry in ipairs(best.form) do
        local p, value = entry.parameter, nil
        if best.taken[i] then
            value = values[best.taken[i]]
        elseif tuples[p.kind] then
            value = loose_numbers(best, values, count, tuples[p.kind])
        else
            value = convertible(call, best, values, count, p)
        end
        if value == nil and tuples[p.kind] then value = convertible(call, best, values, count, p) end
        named[p.name] = value
        call.wanted[p.name] = not entry.optional
    end
    return named
end

-- Whether the value fits the parameter, independent of the name of its field.
local function is_meant(value, p)
    if p.kind == 'lights' then return handle(type(value) == 'table' and rawget(value, 1) or value) == 'light' end
    if p.kind == 'output' then return type(value) == 'string' and find(value, '.', 1, true) end
    return (p.kind == 'node' or p.kind == 'material') and handle(value) == p.kind
end

-- The fields of a table with the names of parameters: those with these names, then those with similar ones, then others
-- by their type, of several the first in byte order.
local function name_fields(f, fields)
    local named, names = {}, {}
    for name in next, fields do
        if type(name) == 'string' then names[#names + 1] = name end
    end
    table.sort(names)
    for exact = 1, 0, -1 do
        for _, name in ipairs(names) do
            local p = f[meant_field(f.row, name)]
            if p and (p.name == name) == (exact == 1) and named[p.name] == nil then
                named[p.name] = rawget(fields, name)
            end
        end
    end
    for k = f.first, #f do
        for _, name in ipairs(names) do
            local value = rawget(fields, name)
            if named[f[k].name] == nil and is_meant(value, f[k]) and not meant_field(f.row, name) then
                named[f[k].name] = value
            end
        end
    end
    return named
end

-- Reads the arguments of a call into `args`. Returns false if one without a default is missing or a shape has no
-- extent; and what keeps their texts.
local function forgive(f, args, has_names, ...)
    local call, named = {f = f, counts = {}, wanted = {}, nothing = false}, nil
    local wanted, counts = call.wanted, call.counts
    if has_names then
        named = name_fields(f, (...))
        for k = f.first, #f do wanted[f[k].name] = not f[k].optional end
    else
        named = name_positional(call, {...}, select('#', ...))
        if f.rest then named[f.rest] = {...} end
    end
    local is_scale = f.owner == 'node' and f.name == 'scale'
    if is_scale and not has_names then wanted.y, wanted.z = false, false end
    for k = f.first, #f do
        local p, value = f[k], named[f[k].name]
        if value ~= nil then value = convert(call, value, p) end
        if value == nil and wanted[p.name] then value = default(f, p) end
        -- A missing factor of node:scale is equal to that of x.
        local follows = is_scale and counts.x and named.vector == nil and (p.name == 'y' or p.name == 'z')
        if value == nil and follows then value = named.x end
        named[p.name] = value
        if value ~= nil then counts[p.name] = read(args, f.row, k, value) end
    end
    for k = f.first, #f do
        local p = f[k]
        local may_miss = p.optional or p.ghost_is_none or f.renders and p.kind == 'point'
        if wanted[p.name] and not counts[p.name] and not may_miss then return false end
    end
    return not call.nothing, named
end

-- Handles. A ghost is the result of a function that does not exist: it accepts every call, index and operator. Other
-- handles ignore fields and operators that they do not have, with a warning; fields that a script sets are kept in a
-- table of their own.

-- Adds the arguments, and the entries of tables among them, to the ghost. Returns whether it has a node.
local function take(ghost, ...)
    local has_node = false
    for i = 1, select('#', ...) do
        local value = (select(i, ...))
        has_node = add(ghost, value)
        for k = 1, type(value) == 'table' and min(rawlen(value), 100000) or 0 do
            has_node = add(ghost, rawget(value, k))
        end
    end
    return has_node
end

-- What a call that failed returns. Of a difference the first operand remains.
local function lost(f, ...)
    if f.result == 'nothing' or f.result == 'frames' then return end
    if f.result == 'self' then return (...) end
    if f.result == 'faces' then return {}, {} end
    if f.result == 'bounds' then return three(0.0), three(1.0) end
    local ghost = new_ghost(f.name, false)
    for i = f.first, select('#', ...) do
        if take(ghost, (select(i, ...))) and find(f.name, 'difference', 1, true) then break end
    end
    return ghost
end

local function warn_of(value, what)
    warning(words(value) .. ' has no ' .. what .. ', which is ignored')
end

local fields = {} -- of the handle

local function own_field(value, name) return fields[value] and fields[value][name] end

local function set_field(value, name, new)
    if name == nil then return end
    if handle(value) ~= 'ghost' then
        local is_text = type(name) == 'string' or type(name) == 'number'
        warn_of(value, "field '" .. (is_text and sub(tostring(name), 1, 100) or '?') .. "'")
    end
    fields[value] = fields[value] or {}
    if name == name then fields[value][name] = new end
end

local function handle_field(value, name)
    local own = own_field(value, name)
    if own ~= nil or type(name) ~= 'string' then return own end
    warn_of(value, "field '" .. sub(name, 1, 100) .. "'")
    return new_ghost(name, true)
end

-- A loop over the entries of a ghost ends immediately.
local function ghost_field(value, name)
    local own = own_field(value, name)
    if own ~= nil or type(name) == 'number' then return own end
    return new_ghost(type(name) == 'string' and name or 'ghost', true)
end

-- A method returns the object before the colon. gr.shiny_material({1, 0, 0}, ...) has a colour: the result is a plain
-- material of that colour.
local function ghost_call(ghost, ...)
    local name, is_method = ghost_info(ghost)
    local first = ...
    if is_method and handle(first) then
        if handle(first) == 'ghost' then take(first, select(2, ...)) end
        return first
    end
    local result = new_ghost(name, false)
    take(result, ...)
    for i = 1, (find(name, 'aterial', 1, true) or find(name, 'MATERIAL', 1, true)) and select('#', ...) or 0 do
        local value = (select(i, ...))
        if type(value) == 'table' and rawlen(value) == 3 and type(rawget(value, 1)) == 'number' then
            add(result, plain(value))
        end
    end
    return result
end

-- The result of an operator on a handle is the handle, the first one of two.
local function operator(what, result)
    return function(a, b)
        local value = handle(a) and a or b
        warn_of(value, what)
        if result == nil then return value end
        return result
    end
end

local function ghost_concat(a, b) return tostring(a) .. tostring(b) end
local function no_pairs() return function() end end
local function ghost_arithmetic() return new_ghost('ghost', false) end
local function ghost_order() return false end
local function ghost_length() return 0 end

-- A function of numbers and vectors: 0 takes the place of an argument that it refuses, or of its result.
local function of_numbers(f, name)
    return function(...)
        local args, count, refused = {...}, select('#', ...), 0
        while true do
            local results = table.pack(pcall(f, table.unpack(args, 1, count)))
            if results[1] then return table.unpack(results, 2, results.n) end
            -- luaL_argerror: "bad argument #3 to '?' (a number is needed)"
            local number, why = match(tostring(results[2]), '^bad argument #(%d+) to[^(]*%((.*)%)$')
            local wrong = tonumber(number or 0)
            if wrong < 1 then error(results[2], 0) end
            local again = wrong > refused
            if refused == 0 or not again then
                local what = again and 'it is' or 'the result is'
                warning('gr.' .. name .. ': argument ' .. number .. ': ' .. why .. ': ' .. what .. ' 0')
            end
            if not again then return 0 end
            args[wrong], count, refused = 0, max(count, wrong), wrong
        end
    end
end

-- Changes the metatables of handles, by the names of their types, and the functions of gr that are not in `all`.
local function open(metatables, all, gr)
    functions = all
    for name, f in next, gr do
        if type(f) == 'function' and not all[name] then gr[name] = of_numbers(f, name) end
    end
    for kind, meta in next, metatables do
        local is_ghost = kind == 'ghost'
        local arithmetic, order = is_ghost and ghost_arithmetic or operator('arithmetic'), operator('order', false)
        for _, name in ipairs{'add', 'sub', 'mul', 'div', 'mod', 'pow', 'unm', 'idiv'} do
            meta['__' .. name] = arithmetic
        end
        meta.__lt = is_ghost and ghost_order or order
        meta.__le, meta.__concat, meta.__pairs, meta.__newindex = meta.__lt, ghost_concat, no_pairs, set_field
        meta.__len = is_ghost and ghost_length or operator('length', 0)
        meta.__call = is_ghost and ghost_call or operator('call')
        if kind ~= 'node' then meta.__index = is_ghost and ghost_field or handle_field end
    end
end

return {forgive = forgive, lost = lost, take = take, open = open, fields = fields}
