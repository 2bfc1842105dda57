-- A scene as text. While a script runs, each call of gr that makes an object leaves a record of its checked arguments, and
-- each method of a node joins the record of the node. A picture is written from the records that it reaches, so no shape,
-- material or light is described a second time. In JSON the keys are sorted and the numbers are the shortest that are read
-- as the same; what is used twice has a name in `define`.
local type, next, rawget, rawlen, setmetatable, getmetatable = type, next, rawget, rawlen, setmetatable, getmetatable
local sort, concat = table.sort, table.concat
local format, gmatch, gsub, match, rep, sub, find = string.format, string.gmatch, string.gsub, string.match, string.rep, string.sub, string.find
local tostring, tonumber, number_type, raise = tostring, tonumber, math.type, raise
local WIDTH, SHORT, JSON_NESTED, LUA_NESTED, LOCALS = 120, 30, 150, 20, 100

local OBJECT = {} -- the metatable of records
local records = {} -- by the address of what they made
local given -- the arguments of the call that runs, by name

-- A copy of an argument: the script may change its tables later. Only what gr reads of a table is kept.
local function copy(value)
    local kind = type(value)
    if kind == 'userdata' then
        return records[address(value)] or raise('an object that no function of gr has made cannot be written')
    elseif kind ~= 'table' then
        return value
    end
    local out, count = {}, rawlen(value)
    for k = 1, count do
        local entry = rawget(value, k)
        out[k] = type(entry) == 'number' and entry or copy(entry)
    end
    if count == 0 then
        for key, entry in next, value do
            if type(key) == 'string' then out[key] = copy(entry) end
        end
    end
    return out
end

-- The record as it is now, for a function that copies its argument.
local function snapshot(record)
    if record.copied == record.changes and record.copy then return record.copy end
    local fields, calls, children = {}, {}, {}
    for key, value in next, record.fields do fields[key] = value end
    for k, call in ipairs(record.calls) do calls[k] = call end
    for k, child in ipairs(record.children) do children[k] = child end
    record.copied = record.changes
    record.copy = setmetatable({kind = record.kind, fields = fields, calls = calls, children = children, changes = 0}, OBJECT)
    return record.copy
end

local TRANSFORMS = {translate = true, scale = true, rotate = true, rotate_axis = true, rotate_quat = true, pose = true, reset = true}
local SETTERS = {velocity = true, moves_to = true, spin = true, set_material = true, set_texture = true, set_bump = true}

local function drop(calls, names)
    local kept = 0
    for k = 1, #calls do
        local call = calls[k]
        calls[k] = nil
        if not names[call.name] then
            kept = kept + 1
            calls[kept] = call
        end
    end
end

-- node:displace moves what is below a node at that time: in the text that is all that stands there.
local function mark_below(record)
    for _, list in ipairs {record.children, record.fields.children or {}} do
        for _, child in ipairs(list) do
            if not child.below then
                child.below = true
                mark_below(child)
            end
        end
    end
end

local function add_call(record, name, order)
    local calls = record.calls
    record.changes = record.changes + 1
    if name == 'reset' or name == 'pose' then drop(calls, TRANSFORMS) end
    if name == 'displace' then mark_below(record) end
    record.late = record.late or record.below and (name == 'displace' or name == 'add_child')
    if SETTERS[name] then drop(calls, {[name] = true}) end
    if name == 'add_child' and not record.displaced then
        record.children[#record.children + 1] = given.node
    elseif name ~= 'reset' then
        record.displaced = record.displaced or name == 'displace'
        calls[#calls + 1] = {name = name, fields = given, order = TRANSFORMS[name] and order}
    end
end

-- --- texts ---

-- The positional forms of a method: lists of its arguments, with the number of those that must be there.
local parsed = {}
local function forms_of(name)
    if parsed[name] then return parsed[name] end
    local out = {}
    for k, form in ipairs(forms(name)) do
        out[k] = {needed = 0}
        for argument, optional in gmatch(form, '([%w_]+)([?]?)') do
            out[k][#out[k] + 1] = argument
            if optional == '' then out[k].needed = #out[k] end
        end
    end
    parsed[name] = out
    return out
end

-- The arguments of a call as one of these forms, or nil.
local function in_form(call)
    local fields, total = call.fields, 0
    for _ in next, fields do total = total + 1 end
    for _, form in ipairs(forms_of(call.name)) do
        local count = 0
        while form[count + 1] and fields[form[count + 1]] ~= nil do count = count + 1 end
        if count == total and count > 0 and count >= form.needed then
            local list = count == 1 and (fields.vector or fields.quaternion) or {}
            for k = 1, #list == 0 and count or 0 do list[k] = fields[form[k]] end
            return list
        end
    end
end

-- The keys of a table by their ranks and names: one list for all tables with these keys.
local known_keys = {}
local function sorted_keys(t, ranks)
    local keys, count = {}, 0
    for key in next, t do
        count = count + 1
        keys[count] = key
    end
    if count < 2 then return keys end
    local signature = concat(keys, ' ')
    if not known_keys[signature] then
        sort(keys, ranks and function(a, b) return (ranks[a] or ' ') .. a < (ranks[b] or ' ') .. b end)
        known_keys[signature] = keys
    end
    return known_keys[signature]
end

local function is_list(value)
    return #value > 0 or next(value) == nil
end

-- What a record is in the file: a table of JSON. `shown`: those of the picture.
local shown
local function members(record)
    if shown[record] then return shown[record] end
    if record.late then raise('a node below a displaced one was displaced, or has got a child, after it; write the scene with displace last') end
    local out = {type = record.kind}
    shown[record] = out
    for key, value in next, record.fields do out[key == 'type' and 'field_type' or key] = value end
    if record.children and #record.children > 0 then
        local all = {}
        for k, child in ipairs(record.fields.children or {}) do all[k] = child end
        for _, child in ipairs(record.children) do all[#all + 1] = child end
        out.children = all
    end
    if record.calls and #record.calls > 0 then
        local calls = {}
        for k, call in ipairs(record.calls) do calls[k] = {[call.name] = in_form(call) or call.fields} end
        out.transform = calls
    end
    return out
end

-- Counts how often each record is used, and lists them so that those inside come first. After `nested`
-- values in each other one gets a name.
local function survey(roots, nested)
    local uses, depths, list, orders = {}, {}, {}, {}
    local function visit(value)
        local deepest, record = 0, getmetatable(value) == OBJECT and value
        if record then
            uses[record] = (uses[record] or 0) + 1
            if uses[record] > 1 then return depths[record] or 0 end
            for _, call in ipairs(record.calls or {}) do
                if call.order then orders[call.order] = true end
            end
            value = members(record)
        end
        for _, entry in next, value do
            local depth = type(entry) == 'table' and visit(entry) or 0
            deepest = deepest < depth and depth or deepest
        end
        if not record then return deepest + 1 end
        if deepest > nested then uses[record], deepest = uses[record] + 1, 0 end -- it gets a name
        depths[record] = deepest + 1
        list[#list + 1] = record
        return deepest + 1
    end
    for _, root in ipairs(roots) do visit(root) end
    return uses, list, orders
end

-- The shortest that is read as the same number. What gr takes is a float, so an integer that none is equal to is written
-- as the nearest one.
local function number_text(x)
    if number_type(x) == 'integer' then
        if x + 0.0 == x then return format('%d', x) end
        x = x + 0.0
    end
    if x == 0 then return 1 / x < 0 and '-0.0' or '0' end
    local text = format('%.15g', x) -- of whole numbers below 1e15 all digits
    if tonumber(text) ~= x then text = format('%.16g', x) end
    return tonumber(text) == x and text or format('%.17g', x)
end

-- One line if it is short, else a line for each part, and for numbers as many as fit; `step`: their indentation beyond that
-- of the whole.
local function join(parts, open, close, indent, step)
    local count, width, lines = #parts, #open + #close + #indent + 2 * #parts, false
    for k = 1, count do
        width = width + #parts[k]
        lines = width > WIDTH or find(parts[k], '\n', 1, true)
        if lines then break end
    end
    if not lines then return open .. concat(parts, ', ') .. close end
    local out, margin = {open}, '\n' .. indent .. step
    local line = 0
    for k = 1, count do
        local text = k < count and parts[k] .. ',' or parts[k]
        local is_short = #parts[k] < SHORT and not find(text, '[\n{]')
        local ends = line == 0 or not is_short or line + #text + #margin > WIDTH
        out[2 * k], out[2 * k + 1] = ends and margin or ' ', text
        line = is_short and (ends and 0 or line + 1) + #text or 0
    end
    out[#out + 1] = '\n' .. indent .. close
    return concat(out)
end

-- Names of the records that are used more than once.
local function name_records(uses, list, pattern, reserved)
    local names, taken, numbers = {}, {}, {}
    for _, record in ipairs(list) do
        if uses[record] > 1 then
            local own = type(record.fields.name) == 'string' and gsub(record.fields.name, pattern, '_') or record.kind
            if own == '' or find(own, '^%d') then own = '_' .. own end
            local name, number = own, numbers[own] or 1
            while taken[name] or reserved[name] do
                number = number + 1
                name = own .. '_' .. number
            end
            taken[name], names[record], numbers[own] = true, name, number
        end
    end
    return names
end

local function json_of(names)
    local text_of
    local labels = setmetatable({}, {__index = function(labels, key)
        labels[key] = quote(key) .. ': '
        return labels[key]
    end})
    local function object(t, indent)
        local parts, inner = {}, indent .. ' '
        for k, key in ipairs(sorted_keys(t)) do parts[k] = labels[key] .. text_of(t[key], inner) end
        return join(parts, '{', '}', indent, ' ')
    end
    function text_of(value, indent, defines)
        local kind = type(value)
        if kind == 'number' then return number_text(value) end
        if kind == 'boolean' then return tostring(value) end
        if kind == 'string' then
            local text, is_utf8 = quote(value)
            return is_utf8 and text or raise('a text is not UTF-8, so JSON cannot have it: ' .. value)
        end
        if getmetatable(value) == OBJECT then
            if names[value] and not defines then return '{"ref": ' .. quote(names[value]) .. '}' end
            return object(members(value), indent)
        end
        if not is_list(value) then return object(value, indent) end
        local parts, inner = {}, indent .. ' '
        for k, entry in ipairs(value) do parts[k] = type(entry) == 'number' and number_text(entry) or text_of(entry, inner) end
        return join(parts, '[', ']', indent, ' ')
    end
    return text_of, object
end

local function one_order(orders)
    local order = next(orders)
    if order and next(orders, order) then raise('gr.transform_order changes within the scene, which cannot be written') end
    return order
end

local function write_json(root, picture, state)
    local uses, list, orders = survey({root, picture}, JSON_NESTED)
    local names = name_records(uses, list, '[%c"\\]', {})
    local text_of, object = json_of(names)
    local define, by_name = {}, {}
    for record, name in next, names do by_name[name] = record end
    for k, name in ipairs(sorted_keys(by_name)) do define[k] = '  ' .. quote(name) .. ': ' .. text_of(by_name[name], '  ', true) end
    local order, out = one_order(orders), {}
    if state.classic then out[#out + 1] = '"defaults": "classic"' end
    if #define > 0 then out[#out + 1] = '"define": {\n' .. concat(define, ',\n') .. '\n }' end
    out[#out + 1] = '"gray": ' .. number_text(state.version)
    out[#out + 1] = '"nodes": [\n  ' .. text_of(root, '  ') .. '\n ]'
    out[#out + 1] = '"picture": ' .. object(picture, ' ')
    if state.time > 0 then out[#out + 1] = '"time": ' .. number_text(state.time) end
    if order and order ~= 'new' then out[#out + 1] = '"transform_order": ' .. quote(order) end
    return '{' .. concat(out, ',\n ') .. '\n}\n'
end

-- --- Lua ---

local KEYWORDS = {gr = true, scene = true, shared = true}
for word in gmatch('and break do else elseif end false for function goto if in local nil not or repeat return then true until while', '%a+') do
    KEYWORDS[word] = true
end
-- Where fields stand among the others, which are in the order of their names.
local RANK = {name = '\1', file = '\1', node = '\1', from = '\4', to = '\5', width = '\2', height = '\3', eye = '\4', target = '\5', view = '\5', corner = '\5', along = '\5',
              up = '\6', fov = '\7', children = '~', operands = '~'}

local function lua_string(text)
    if find(text, "[%c'\\\128-\255]") then return (gsub(format('%q', text), '\\\n', '\\n')) end
    return "'" .. text .. "'"
end

-- The operations of a program, as many on a line as fit.
local function code_text(code)
    local lines, line = {}, ''
    for statement in gmatch(code, '[^;]+;? ?') do
        if #line + #statement > WIDTH then
            lines[#lines + 1] = gsub(line, ' $', '')
            line = ''
        end
        line = line .. statement
    end
    lines[#lines + 1] = line
    return '[[\n' .. concat(lines, '\n') .. ']]'
end

-- names: of records, as expressions.
local function lua_of(names)
    local text_of
    local function fields_text(t, indent)
        local parts, inner = {}, indent .. '  '
        for k, key in ipairs(sorted_keys(t, RANK)) do
            local name = find(key, '^[%a_][%w_]*$') and (key == 'scene' or not KEYWORDS[key]) and key or '[' .. lua_string(key) .. ']'
            parts[k] = name .. ' = ' .. (key == 'code' and code_text(t[key]) or text_of(t[key], inner))
        end
        return join(parts, '{', '}', indent, '  ')
    end
    local function record_text(record, indent)
        local fields, calls = {}, {}
        for key, value in next, members(record) do fields[key] = value end
        local is_group = record.kind == 'node' or record.kind == 'joint'
        local children = not is_group and fields.children or {}
        fields.type, fields.field_type, fields.transform, fields.children = fields.field_type, nil, nil, is_group and fields.children or nil
        for _, child in ipairs(children) do calls[#calls + 1] = ':add_child(' .. text_of(child, indent .. '  ') .. ')' end
        for _, call in ipairs(record.calls or {}) do
            local list, parts = in_form(call), {}
            for k, argument in ipairs(list or {}) do parts[k] = text_of(argument, indent .. '  ') end
            calls[#calls + 1] = ':' .. call.name .. (list and '(' .. concat(parts, ', ') .. ')' or fields_text(call.fields, indent))
        end
        return 'gr.' .. record.kind .. fields_text(fields, indent) .. concat(calls)
    end
    function text_of(value, indent, defines)
        local kind = type(value)
        if kind == 'number' then return number_text(value) end
        if kind == 'boolean' then return tostring(value) end
        if kind == 'string' then return lua_string(value) end
        if getmetatable(value) == OBJECT then return not defines and names[value] or record_text(value, indent) end
        if not is_list(value) then return fields_text(value, indent) end
        local parts = {}
        for k, entry in ipairs(value) do parts[k] = text_of(entry, indent .. '  ') end
        return join(parts, '{', '}', indent, '  ')
    end
    return text_of
end

-- A picture with the defaults of calls by position is such a call, if it has what that needs.
local function positional(picture, text_of)
    local words, rest = {'scene'}, {}
    for key, value in next, picture do rest[key] = value end
    for name in gmatch('file width height eye view up fov', '%a+') do
        if picture[name] == nil then return nil end
        words[#words + 1] = text_of(picture[name], '  ')
        rest[name] = nil
    end
    for name in gmatch('ambient lights', '%a+') do
        words[#words + 1] = text_of(picture[name] or name == 'lights' and {} or {0, 0, 0}, '  ')
        rest[name] = nil
    end
    if next(rest) then words[#words + 1] = text_of(rest, '') end
    return 'gr.render(' .. concat(words, ', ') .. ')'
end

local function write_lua(root, picture, state)
    local uses, list, orders = survey({root, picture}, LUA_NESTED)
    local plain = name_records(uses, list, '[^%w_]', KEYWORDS)
    local order, count, names, out = one_order(orders), 0, {}, {'-- A scene written by gray\n'}
    for _ in next, plain do count = count + 1 end
    local few = count <= LOCALS
    for record, name in next, plain do names[record] = few and name or 'shared.' .. name end
    if not few then out[#out + 1] = 'local shared = {}\n' end
    if order and order ~= 'new' then out[#out + 1] = 'gr.transform_order(' .. lua_string(order) .. ')\n' end
    if state.spins and state.time > 0 then raise('a later frame of an animation with node:spin cannot be written as a script') end
    local text_of = lua_of(names)
    for _, record in ipairs(list) do
        if names[record] then
            out[#out + 1] = (few and 'local ' or '') .. names[record] .. ' = ' .. text_of(record, '', true) .. '\n'
        end
    end
    out[#out + 1] = 'local scene = ' .. text_of(root, '') .. '\n'
    local call, kind = state.classic and not picture.type and positional(picture, text_of), picture.type or 'render'
    if state.classic and not call and picture.sky == nil then -- what such a script shows behind its scene
        if picture.background == 'transparent' then raise('the background of calls by position is not that of tables, so it cannot be written as a script') end
        picture.background = picture.background or 'gradient'
    end
    picture.node, picture.type = setmetatable({}, OBJECT), nil
    names[picture.node] = 'scene'
    out[#out + 1] = (call or 'gr.' .. kind .. text_of(picture, '')) .. '\n'
    return concat(out)
end

-- --- what gray calls ---

return {
    begin = function() given = {} end,
    note = function(name, value) given[name] = copy(value) end,
    program = function(name, code, images)
        local fields = {code = code}
        for k, image in ipairs(images) do
            for texture, record in next, records do
                if record.kind == 'texture' and image_function(texture) == image then fields['image' .. k] = record end
            end
        end
        given[name] = setmetatable({kind = 'program', fields = fields}, OBJECT)
    end,
    nodes = function(name, list)
        local out = {}
        for k, node in ipairs(list) do out[k] = records[node] end
        given[name] = out
    end,
    made = function(made, kind)
        if kind == 'geometry' and given.primitive then given.primitive = snapshot(given.primitive) end
        records[made] = setmetatable({kind = kind, fields = given, calls = {}, children = {}, changes = 0}, OBJECT)
    end,
    object = function(fields, made, kind)
        records[made] = setmetatable({kind = kind, fields = fields, calls = {}, children = {}, changes = 0}, OBJECT)
    end,
    called = function(self, name, order)
        if records[self] then add_call(records[self], name, order) end
    end,
    add_light = function(light)
        given.lights = given.lights or {}
        given.lights[#given.lights + 1] = records[light]
    end,
    -- A model on the command line: `plain`, the kd of its material if the file has none; whether z is up in the file.
    model = function(node, plain, is_turned)
        local record = records[node]
        if plain then record.fields.material = setmetatable({kind = 'material', fields = {kd = {plain, plain, plain}}}, OBJECT) end
        if is_turned then
            record.calls[1] = {name = 'rotate', fields = {axis = 'x', angle = -90}, order = 'new'}
        end
    end,
    picture = function(kind, self, state, more)
        local picture, root = given, given.node or records[self]
        shown = {}
        for name, value in next, more do
            if name ~= 'view' or not picture.target then picture[name] = value end
        end
        picture.node = nil
        if kind ~= 'render' then picture.type = kind end
        if state.shutter then picture.shutter = state.shutter end
        return (state.lua and write_lua or write_json)(root, picture, state)
    end,
}
