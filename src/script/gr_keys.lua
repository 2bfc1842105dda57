-- gr.keys: values at times, and a function of seconds that interpolates them. Every value is a row of numbers, divided
-- into fields of three kinds: numbers that are mixed linearly, quaternions and directions. The latter two are points of
-- unit spheres, where a great circle replaces the straight line (K. Shoemake, "Animating Rotation with Quaternion
-- Curves", SIGGRAPH 1985). Between two keys every curve is a cubic Bezier curve, evaluated by de Casteljau's scheme
-- with the mix of the field. So a value that does not change keeps its bits. The inner control values of curve =
-- 'catmull' are a third of a step along the tangents of Catmull and Rom, "A Class of Local Interpolating Splines",
-- 1974, for keys at any distances.
local rawget, rawlen, type, next, ipairs, unpack = rawget, rawlen, type, next, ipairs, table.unpack
local format, vector = string.format, vector
local sqrt, sin, cos, atan = math.sqrt, math.sin, math.cos, math.atan
local FIELDS, KEYS, WIDTH = 32, 1 << 20, 64
local directions = {view = true, up = true, view_to = true, up_to = true}
local curves = {linear = true, catmull = true, bezier = true}

local function is_finite(x) return type(x) == 'number' and x - x == 0 end

-- Values of one field: lists of numbers.

local function length(v)
    local sum = 0.0
    for i = 1, #v do sum = sum + v[i] * v[i] end
    return sqrt(sum)
end

-- False: it has length 0.
local function normalize(v)
    local long = length(v)
    if not (long > 0 and is_finite(long)) then return false end
    for i = 1, #v do v[i] = v[i] / long end
    return true
end

-- The angle between unit vectors (W. Kahan, "How Futile are Mindless Assessments of Roundoff in Floating-Point
-- Computation?", 2006, section 12).
local function angle_of(a, b)
    local difference, sum = 0.0, 0.0
    for i = 1, #a do
        local minus, plus = a[i] - b[i], a[i] + b[i]
        difference, sum = difference + minus * minus, sum + plus * plus
    end
    return 2 * atan(sqrt(difference), sqrt(sum))
end

-- Writes to out, which may be a or b. Opposite unit vectors have no shortest great circle: the result is a.
local function mix(unit, a, b, share, out)
    if not unit then
        for i = 1, #a do out[i] = a[i] + (b[i] - a[i]) * share end
        return out
    end
    local angle = angle_of(a, b)
    local sine, from, to = sin(angle), sin((1 - share) * angle), sin(share * angle)
    if angle == 0 or not (sine > 0x1p-40) then from, sine, to = 1.0, 1.0, 0.0 end
    for i = 1, #a do out[i] = (from * a[i] + to * b[i]) / sine end
    return out
end

-- The difference from a to b. For unit vectors it is the tangent at a whose length is the angle.
local function difference(unit, a, b)
    local out, along = {}, 0.0
    for i = 1, #a do out[i] = b[i] - a[i] end
    if not unit then return out end
    for i = 1, #a do along = along + out[i] * a[i] end
    for i = 1, #a do out[i] = out[i] - along * a[i] end
    local scale = normalize(out) and angle_of(a, b) or 0.0
    for i = 1, #a do out[i] = out[i] * scale end
    return out
end

-- The value at `factor` times a difference from a.
local function move(unit, a, by, factor)
    local scale, keep, long, out = factor, 1.0, length(by), {}
    if unit and long > 0 then keep, scale = cos(factor * long), sin(factor * long) / long end
    for i = 1, #a do out[i] = keep * a[i] + scale * by[i] end
    return out
end

-- Reading. read.key is the number of the key, read.at what of it is read, read.fields the form of the values: a list of
-- {name, kind, count, unit}, without name if the value is the only field.

local function refuse(read, name, why)
    raise(format('gr.keys: %s%s of keys[%d] %s', name and name .. ' in ' or '', read.at, read.key, why))
end

local function form_of(read, name, value)
    if type(value) == 'number' then return 'number', 1 end
    if colour(value) then return 'colour', 3 end
    if type(value) ~= 'table' then refuse(read, name, 'must be a number, a colour or a table of numbers') end
    local count = rawlen(value)
    if name == 'rotate' then
        if count ~= 4 then refuse(read, name, 'must be a quaternion {w, x, y, z}') end
        return 'turn', 4, true
    elseif name and directions[name] then
        if count ~= 3 then refuse(read, name, 'must be a direction {x, y, z}') end
        return 'direction', 3, true
    end
    if count == 0 or count > WIDTH then refuse(read, name, 'must be a table of 1 to 64 numbers') end
    return 'tuple', count
end

-- A table without entry 1 and without the mark of a colour has named fields.
local function has_names(value)
    return type(value) == 'table' and not colour(value) and rawget(value, 1) == nil
end

-- The first value determines the form of the others.
local function describe(read, value)
    local names, width = {}, 0
    if not has_names(value) then
        local kind, count, unit = form_of(read, nil, value)
        read.fields = {{kind = kind, count = count, unit = unit}}
        return
    end
    for name in next, value do
        if type(name) ~= 'string' then
            refuse(read, nil, 'must be a number, a table of numbers, or a table with names')
        end
        if #names == FIELDS then refuse(read, nil, 'has more than 32 fields') end
        names[#names + 1] = name
    end
    if #names == 0 then refuse(read, nil, 'is an empty table') end
    table.sort(names)
    read.fields, read.named = {}, true
    for i = 1, #names do
        local kind, count, unit = form_of(read, names[i], rawget(value, names[i]))
        read.fields[i], width = {name = names[i], kind = kind, count = count, unit = unit}, width + count
        if width > WIDTH then refuse(read, nil, 'has more than 64 numbers') end
    end
end

local function read_field(read, field, value)
    if value == nil then refuse(read, field.name, 'is missing') end
    local kind, count = form_of(read, field.name, value)
    if kind ~= field.kind or count ~= field.count then
        refuse(read, field.name, 'is of another kind than the value of keys[1]')
    end
    if kind == 'colour' then return {colour(value)} end
    local out = {}
    for i = 1, count do
        local x = kind == 'number' and value or kind ~= 'number' and rawget(value, i)
        if not is_finite(x) then refuse(read, field.name, 'must be of finite numbers') end
        out[i] = x + 0.0
    end
    if field.unit and not normalize(out) then refuse(read, field.name, 'must not be 0') end
    return out
end

-- A row has a list of numbers for each field.
local function read_row(read, value)
    local row, given, fields = {}, 0, read.fields
    if has_names(value) ~= (read.named or false) then
        refuse(read, nil, 'is of another kind than the value of keys[1]')
    end
    if not read.named then return {read_field(read, fields[1], value)} end
    for i = 1, #fields do row[i] = read_field(read, fields[i], rawget(value, fields[i].name)) end
    for _ in next, value do given = given + 1 end
    if given ~= #fields then refuse(read, nil, 'has other fields than the value of keys[1]') end
    return row
end

local function read_key(read, key)
    local time, rows, k = rawget(key, 1), read.rows, read.key
    if not is_finite(time) then
        local rest = type(time) == 'number' and ', with a finite number of seconds' or ''
        raise(format('gr.keys: keys[%d] must be {seconds, value}%s', k, rest))
    end
    read.times[k] = time + 0.0
    if k > 1 and not (time > read.times[k - 1]) then
        raise(format('gr.keys: the time of keys[%d] is ', k) .. read.times[k] ..
            format(', not later than that of keys[%d], ', k - 1) .. read.times[k - 1])
    end
    read.at = 'the value'
    rows.value[k] = read_row(read, rawget(key, 2))
    for _, name in ipairs{'before', 'after'} do
        local given = rawget(key, name)
        read.at = name
        if given ~= nil and read.curve ~= 'bezier' then refuse(read, nil, "needs curve = 'bezier'") end
        if read.curve == 'bezier' then
            rows[name][k] = given ~= nil and read_row(read, given) or {unpack(rows.value[k])}
        end
    end
    for part in next, key do
        if not (part == 'before' or part == 'after' or math.type(part) == 'integer' and part <= 2) then
            raise(format("gr.keys: keys[%d] must be {seconds, value}, for 'bezier' with before and after", k))
        end
    end
end

-- A quaternion and its negative are the same rotation. Of the two, the one closer to its neighbour is chosen, for the
-- shorter rotation.
local function nearer(field, neighbour, value)
    local dot = 0.0
    if field.kind ~= 'turn' then return value end
    for i = 1, 4 do dot = dot + neighbour[i] * value[i] end
    return dot < 0 and {-value[1], -value[2], -value[3], -value[4]} or value
end

-- The derivative at a key, times a third of the steps on both sides.
local function set_tangent(read, f, k)
    local rows, times, unit = read.rows, read.times, read.fields[f].unit
    local first, last = k > 1 and k - 1 or k, k < #times and k + 1 or k
    local value, span = rows.value[k][f], times[last] - times[first]
    rows.before[k], rows.after[k] = rows.before[k] or {}, rows.after[k] or {}
    if first == last then return end
    local forward = difference(unit, value, rows.value[last][f])
    local backward = difference(unit, value, rows.value[first][f])
    for i = 1, #forward do forward[i] = (forward[i] - backward[i]) / span end
    rows.before[k][f] = move(unit, value, forward, (times[first] - times[k]) / 3)
    rows.after[k][f] = move(unit, value, forward, (times[last] - times[k]) / 3)
end

local function make_controls(read)
    local value, before, after = read.rows.value, read.rows.before, read.rows.after
    for f, field in ipairs(read.fields) do
        for k = 1, #value do
            local last = value[k > 1 and k - 1 or k][f]
            value[k][f] = nearer(field, last, value[k][f])
            if read.curve == 'bezier' then
                before[k][f] = nearer(field, value[k][f], before[k][f])
                after[k][f] = nearer(field, value[k][f], after[k][f])
            end
            if field.kind == 'direction' and angle_of(last, value[k][f]) > math.pi - 1e-6 then
                read.key, read.at = k, 'the value'
                refuse(read, field.name,
                    'is opposite to that of the previous key: there is no shortest rotation between them')
            end
        end
        for k = 1, read.curve == 'catmull' and #value or 0 do set_tangent(read, f, k) end
    end
end

-- The value of field f in the interval from key k on.
local function interpolate(read, f, k, share)
    local rows, unit = read.rows, read.fields[f].unit
    local a, d = rows.value[k][f], rows.value[k + 1][f]
    if read.curve == 'linear' then return mix(unit, a, d, share, {}) end
    local b, c = rows.after[k][f], rows.before[k + 1][f]
    a, b, c = mix(unit, a, b, share, {}), mix(unit, b, c, share, {}), mix(unit, c, d, share, {})
    a, b = mix(unit, a, b, share, a), mix(unit, b, c, share, b)
    return mix(unit, a, b, share, a)
end

local function answer(field, v)
    if field.kind == 'number' then return v[1] end
    if field.kind == 'colour' then return {v[1], v[2], v[3], encoding = 'srgb'} end
    if #v == 3 then return vector(v[1], v[2], v[3]) end
    return {unpack(v)}
end

-- The fraction of the interval, mapped by the function `ease` of the call.
local function eased(ease, share)
    local out = ease(share)
    if not is_finite(out) then raise('gr.keys: ease(' .. share .. ') must be a finite number') end
    return out + 0.0
end

local function value_at(read, given)
    local time = given
    if time == nil then time = now() end
    if type(time) ~= 'number' and type(time) ~= 'string' or not tonumber(time) then
        raise('gr.keys: the time must be a number of seconds, not ' .. (is_recorded(time) and 'a number of a recorded function' or words(time)))
    end
    time = tonumber(time) + 0.0
    if time ~= time then raise('gr.keys: the time is not a number (nan)') end
    -- low: the last key that is not later; high: the first key that is later.
    local times, share = read.times, nil
    local low, high = 1, #times + 1
    while high - low > 1 do
        local middle = low + (high - low) // 2
        if times[middle] <= time then low = middle else high = middle end
    end
    if high <= #times and time > times[low] then
        share = (time - times[low]) / (times[high] - times[low])
        share = read.ease and eased(read.ease, share) or share
    end
    local out = {}
    for f, field in ipairs(read.fields) do
        local value = answer(field, share and interpolate(read, f, low, share) or read.rows.value[low][f])
        if not read.named then return value end
        out[field.name] = value
    end
    return out
end

local function check_fields(keys, count)
    for name in next, keys do
        local index = math.type(name) == 'integer' and name or 0
        if index > count then raise(format('gr.keys: keys[%d] is missing', count + 1)) end
        if index < 1 and name ~= 'curve' and name ~= 'ease' then
            raise(format("gr.keys: unknown field '%s'; the fields are curve, ease", tostring(name)))
        end
    end
end

return function(...)
    local keys = ...
    if select('#', ...) ~= 1 or type(keys) ~= 'table' then
        raise('gr.keys: one table of keys {seconds, value} is needed')
    end
    local count = rawlen(keys)
    if count == 0 or count > KEYS then raise(format('gr.keys: 1 to %d keys {seconds, value} are needed', KEYS)) end
    check_fields(keys, count)
    local curve, ease = rawget(keys, 'curve'), rawget(keys, 'ease')
    if curve == nil then curve = 'linear' end
    if not curves[curve] then raise("gr.keys: curve must be 'linear', 'catmull' or 'bezier'") end
    for k = 1, count do
        if type(rawget(keys, k)) ~= 'table' then raise(format('gr.keys: keys[%d] must be {seconds, value}', k)) end
    end
    local read = {curve = curve, key = 1, at = 'the value', times = {}, rows = {value = {}, before = {}, after = {}}}
    describe(read, rawget(rawget(keys, 1), 2))
    for k = 1, count do
        read.key = k
        read_key(read, rawget(keys, k))
    end
    make_controls(read)
    if ease ~= nil and type(ease) ~= 'function' then
        raise('gr.keys: ease must be a function, as those of the library easing')
    end
    read.ease = ease
    return function(time) return value_at(read, time) end
end
