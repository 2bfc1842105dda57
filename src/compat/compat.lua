-- Functions of Lua 5.0 and 5.1 that 5.4 no longer has, in Lua (compat.c has those in C).
local scene = scene_globals()
local type, getinfo, getupvalue, getmetatable = type, debug.getinfo, debug.getupvalue, debug.getmetatable
local load, pairs, loaded, seed_random = scene.load, scene.pairs, scene.package.loaded, math.randomseed

local function check(value, index, name, kind)
    if type(value) == kind then return end
    local meta = getmetatable(value)
    local given = value == nil and 'no value' or meta and rawget(meta, '__name') or type(value)
    raise("bad argument #" .. index .. " to '" .. name .. "' (" .. kind .. ' expected, got ' .. given .. ')')
end

function scene.table.getn(t)
    check(t, 1, 'getn', 'table')
    return #t
end

-- Since 5.1 the length of a table is found from its entries.
function scene.table.setn(t) return t end

function scene.table.maxn(t)
    check(t, 1, 'maxn', 'table')
    local largest = 0.0
    for k in next, t do
        if type(k) == 'number' and k > largest then largest = k + 0.0 end
    end
    return largest
end

-- f(key, value) until it returns something.
function scene.table.foreach(t, f)
    check(t, 1, 'foreach', 'table')
    check(f, 2, 'foreach', 'function')
    for k, v in pairs(t) do
        local result = f(k, v)
        if result ~= nil then return result end
    end
end

function scene.table.foreachi(t, f)
    check(t, 1, 'foreachi', 'table')
    check(f, 2, 'foreachi', 'function')
    for k = 1, #t do
        local result = f(k, t[k])
        if result ~= nil then return result end
    end
end

-- Without arguments Lua's own would use the time: here it restarts the sequence. Floats are truncated, as in Lua 5.1.
function scene.math.randomseed(x, second)
    local seed = first_seed()
    if x ~= nil then
        seed = tonumber(x)
        check(seed or x, 1, 'randomseed', 'number')
        if math.type(seed) == 'float' then
            seed = math.abs(seed) < 0x1p62 and math.tointeger((math.modf(seed))) or 0
        end
    end
    seed_random(seed, second or 0)
end

function scene.loadstring(text, name)
    if type(text) ~= 'number' then check(text, 1, 'loadstring', 'string') end
    return load(text, name)
end

-- The number of the upvalue _ENV of a function, and its value; nothing if it uses no globals.
local function environment_of(f)
    for k = 1, 255 do
        local name, value = getupvalue(f, k)
        if name == '_ENV' then return k, value end
        if not name then return nil end
    end
end

-- What argument 1 of getfenv and setfenv means: a function, or a level of the stack.
local function function_at(at, name)
    if type(at) == 'function' then return at end
    local level = at == nil and 1 or math.tointeger(at) or type(at) == 'number' and -1 or at
    check(level, 1, name, 'number')
    local frame = level >= 1 and level <= 200 and getinfo(level + 2, 'f')
    return frame and frame.func or nil
end

function scene.getfenv(at)
    local f = function_at(at, 'getfenv')
    local k, value
    if f then k, value = environment_of(f) end
    if k then return value end
    return scene
end

-- The function gets a variable _ENV of its own; functions that shared the old one keep it.
function scene.setfenv(at, environment)
    check(environment, 2, 'setfenv', 'table')
    local f = function_at(at, 'setfenv')
    if not f or getinfo(f, 'S').what == 'C' then raise('setfenv: there is no such Lua function') end
    local k = environment_of(f)
    if k then debug.upvaluejoin(f, k, function() return environment end, 1) end
    return f
end

-- Names that are not in the module are looked up in the globals.
function scene.package.seeall(module)
    check(module, 1, 'seeall', 'table')
    local meta = debug.getmetatable(module) or {}
    debug.setmetatable(module, meta)
    meta.__index = scene
end

-- module(name, ...): the table package.loaded[name] (created if necessary, and stored as a global of that dotted name)
-- becomes the environment of the calling chunk; the further arguments are called with it. `module(..., f)`: require
-- gives the chunk the name of its file as well.
function scene.module(name, ...)
    check(name, 1, 'module', 'string')
    local module = loaded[name]
    if type(module) ~= 'table' then
        module = scene
        for part in string.gmatch(name, '[^.]+') do
            if type(rawget(module, part)) ~= 'table' then rawset(module, part, {}) end
            module = rawget(module, part)
        end
        loaded[name] = module
    end
    module._M, module._NAME = module, name
    local frame = getinfo(2, 'f')
    local k = frame and environment_of(frame.func)
    if k then debug.setupvalue(frame.func, k, module) end -- the chunk and all its functions share this variable
    for i = 1, select('#', ...) do
        local option = (select(i, ...))
        if type(option) == 'function' then option(module) end
    end
end

scene.math.mod, scene.string.gfind, scene.unpack = math.fmod, string.gmatch, scene.table.unpack
scene.math.randomseed() -- random numbers start from the seed of the command line

-- The value of a text that is a literal, or the text. Tables are evaluated without any globals.
return function(text)
    local first, last, number = string.sub(text, 1, 1), string.sub(text, -1), tonumber(text)
    if number then return number end
    if text == 'nil' then return nil end
    local is_quoted = #text > 1 and first == last and (first == '"' or first == "'")
    local is_table = first == '{' and last == '}' and not string.find(text, 'function', 1, true)
    local chunk = (is_quoted or is_table or text == 'true' or text == 'false') and
        load('return ' .. text, '=-D', 't', {})
    local done, value = pcall(chunk or error)
    if done and (is_table or not is_quoted or type(value) == 'string') then return value end
    return text
end
