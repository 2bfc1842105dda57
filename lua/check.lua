-- check: error messages of the library's functions for wrong arguments.
-- Idea: one sentence that names the module, the function and the argument, with the position of the call in the scene,
-- not the line of the library that detected it. Unknown fields of option tables are errors, too.
--
--   local check = require 'check'
--   function M.ball(radius, options)                  -- in a module called solids
--       check.above('solids.ball', 'radius', radius, 0)
--       options = check.options('solids.ball', options, 'n smooth')
--
-- Every function returns its value, or the default if no value was given and there is a default.

local M = {}

local folder = debug.getinfo(1, 'S').source:match '^(.*[/\\])' or '@'

-- Numbers of recorded functions have no value yet. Checks accept them; the comparison with Lua repeats the checks with
-- numbers.
local is_recorded = gr.is_recorded

--- Describes the value of an argument in words.
---@return string
function M.shown(value)
    if value == nil then return 'nothing' end
    if is_recorded(value) then return 'a number of the recorded function' end
    if type(value) == 'number' then return ('%.14g'):format(value) end
    if type(value) == 'string' then return ("'%s'"):format(#value > 40 and value:sub(1, 37) .. '...' or value) end
    if type(value) == 'boolean' then return tostring(value) end
    if type(value) == 'userdata' then return 'a ' .. tostring(value):match '^%a+' end
    return 'a ' .. type(value)
end

local shown = M.shown

--- The first position outside the library, counted from the caller of `error`.
local function level_of_the_scene()
    local level = 3
    while true do
        local info = debug.getinfo(level, 'S')
        if not info then return 3 end
        local source = info.source
        if source:sub(1, 1) == '@' and source:sub(1, #folder) ~= folder then return level - 1 end
        level = level + 1
    end
end

--- Raises "where: text".
---@param where string  'module.function'
---@param text string
function M.fail(where, text)
    local level = level_of_the_scene()
    error(where .. ': ' .. text, level)
end

local function wrong(where, name, wanted, value)
    local level = level_of_the_scene()
    error(('%s: %s must be %s, not %s'):format(where, name, wanted, shown(value)), level)
end

local function is_number(value) return type(value) == 'number' and value == value and math.abs(value) < math.huge end

local function range_words(low, high)
    if low and high then return (' from %.14g to %.14g'):format(low, high) end
    if low then return (' of at least %.14g'):format(low) end
    return high and (' of at most %.14g'):format(high) or ''
end

--- A finite number in a closed range.
---@param where string
---@param name string  of the argument
---@param value any
---@param low number?
---@param high number?
---@param default number?
---@return number
function M.number(where, name, value, low, high, default)
    if value == nil and default ~= nil then return default end
    if is_recorded(value) then return value end
    if not is_number(value) or low and value < low or high and value > high then
        wrong(where, name, 'a number' .. range_words(low, high), value)
    end
    return value
end

--- A finite number above a bound.
function M.above(where, name, value, low, default)
    if value == nil and default ~= nil then return default end
    if is_recorded(value) then return value end
    if not is_number(value) or value <= low then wrong(where, name, ('a number above %.14g'):format(low), value) end
    return value
end

--- A whole number; a float with a whole value is one.
---@return integer
function M.whole(where, name, value, low, high, default)
    if value == nil and default ~= nil then return default end
    local whole = not is_recorded(value) and is_number(value) and math.tointeger(value)
    if not whole or low and whole < low or high and whole > high then
        wrong(where, name, 'a whole number' .. range_words(low, high), value)
    end
    return whole
end

--- A string.
function M.text(where, name, value, default)
    if value == nil and default ~= nil then return default end
    if type(value) ~= 'string' then wrong(where, name, 'a string', value) end
    return value
end

--- true or false.
function M.flag(where, name, value, default)
    if value == nil then return default or false end
    if type(value) ~= 'boolean' then wrong(where, name, 'true or false', value) end
    return value
end

--- A function, or something that can be called.
function M.callable(where, name, value, default)
    if value == nil and default ~= nil then return default end
    local meta = type(value) == 'table' and getmetatable(value)
    if type(value) ~= 'function' and not (type(meta) == 'table' and meta.__call) then
        wrong(where, name, 'a function', value)
    end
    return value
end

--- One of some words.
---@param words string  parted by blanks
function M.word(where, name, value, words, default)
    if value == nil and default ~= nil then return default end
    for word in words:gmatch '%S+' do
        if word == value then return value end
    end
    wrong(where, name, "'" .. words:gsub(' ', "' or '") .. "'", value)
end

--- A table.
function M.table(where, name, value, default)
    if value == nil and default ~= nil then return default end
    if type(value) ~= 'table' then wrong(where, name, 'a table', value) end
    return value
end

--- A list with at least this many entries.
---@param least integer?  default 1
function M.list(where, name, value, least)
    least = least or 1
    if type(value) ~= 'table' then wrong(where, name, 'a table', value) end
    if #value < least then
        M.fail(where, ('%s must have at least %d entr%s, not %d'):format(name, least, least == 1 and 'y' or 'ies', #value))
    end
    return value
end

--- A tuple of numbers, as a point or a colour.
---@param size integer
function M.tuple(where, name, value, size, default)
    if value == nil and default ~= nil then return default end
    if type(value) ~= 'table' then wrong(where, name, ('a tuple of %d numbers'):format(size), value) end
    for k = 1, size do
        if not is_recorded(value[k]) and not is_number(value[k]) then
            M.fail(where, ('%s[%d] must be a number, not %s'):format(name, k, shown(value[k])))
        end
    end
    return value
end

--- A list of tuples of numbers.
---@param size integer  numbers in a tuple
---@param least integer?  default 1
function M.points(where, name, value, size, least)
    M.list(where, name, value, least)
    for i, p in ipairs(value) do
        if type(p) ~= 'table' then wrong(where, ('%s[%d]'):format(name, i), ('a tuple of %d numbers'):format(size), p) end
        for k = 1, size do
            if not is_number(p[k]) then
                M.fail(where, ('%s[%d][%d] must be a number, not %s'):format(name, i, k, shown(p[k])))
            end
        end
    end
    return value
end

--- Faces of a mesh: tuples of at least three 0-based indices below a count.
function M.faces(where, name, value, count)
    M.list(where, name, value, 1)
    for i, face in ipairs(value) do
        if type(face) ~= 'table' or #face < 3 then
            M.fail(where, ('%s[%d] must be a tuple of at least 3 indices'):format(name, i))
        end
        for k, index in ipairs(face) do
            if math.type(index) ~= 'integer' and not (is_number(index) and math.tointeger(index)) or index < 0 or index >= count then
                M.fail(where, ('%s[%d][%d] must be an index from 0 to %d, not %s'):format(name, i, k, count - 1, shown(index)))
            end
        end
    end
    return value
end

--- A table of options whose fields are all known; nil gives an empty one.
---@param known string  the names, parted by blanks
---@return table
function M.options(where, options, known)
    if options == nil then return {} end
    if type(options) ~= 'table' then wrong(where, 'options', 'a table', options) end
    local padded, strange = ' ' .. known .. ' ', nil
    for name in pairs(options) do
        if type(name) ~= 'string' or not padded:find(' ' .. name .. ' ', 1, true) then
            local word = type(name) == 'string' and name or shown(name)
            if not strange or word < strange then strange = word end
        end
    end
    if strange then M.fail(where, ('there is no option %s; the options are %s'):format(strange, (known:gsub(' ', ', ')))) end
    return options
end

return M
