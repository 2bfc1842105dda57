-- Scripts for Lua 5.0 and 5.1: every name that 5.4 no longer has.
assert(select('#', unpack({1, 2, 3})) == 3)
assert(table.getn({1, 2, 3}) == 3)
table.setn({}, 3)
assert(table.maxn({[7] = 1, [2] = 1}) == 7)
local words = {}
for word in string.gfind('a cow jumps', '%a+') do table.insert(words, word) end
assert(table.getn(words) == 3 and words[2] == 'cow')
assert(math.pow(2, 10) == 1024)
assert(math.mod(7, 4) == 3)
assert(math.log10(1000) == 3)
assert(math.ldexp(0.5, 3) == 4)
local mantissa, exponent = math.frexp(8)
assert(mantissa == 0.5 and exponent == 4)
assert(math.cosh(0) == 1 and math.sinh(0) == 0 and math.tanh(0) == 0)
assert(math.atan2(0, -1) == math.pi)
assert(loadstring('return 2 + 3')() == 5)
local bad, message = loadstring('return +')
assert(bad == nil and type(message) == 'string')

local keys = {}
table.foreach({b = 1, a = 2, 10, 20}, function(key) keys[#keys + 1] = tostring(key) end)
assert(table.concat(keys, ' ') == '1 2 a b')
local found = table.foreachi({5, 6, 7}, function(index, value) if value == 6 then return index end end)
assert(found == 2)

-- arg: the further arguments of a function
local function sum(first, ...)
    local total = first
    for i = 1, arg.n do total = total + (arg[i] or 0) end
    return total, arg.n
end
assert(sum(1, 2, nil, 4, nil) == 7 and select(2, sum(1, 2, nil, 4, nil)) == 4 and select(2, sum(1)) == 0)
local function fixed() return arg end
assert(fixed() == nil and arg == nil and rawget(_G, 'arg') == nil)

-- numbers print as they did
assert(tostring(3.0) == '3' and tostring(6 / 2) == '3' and tostring(-0.5) == '-0.5' and tostring(2 ^ 53) ~= nil)
assert(string.format('%s', 10 / 2) == '5')
assert(tostring(1e100) == '1e+100')

-- random numbers take whole floats
local roll = math.random(1.0, 6.0)
assert(roll >= 1 and roll <= 6)
math.randomseed(42.0)
local first = math.random()
math.randomseed(42)
assert(math.random() == first)
math.randomseed(1.5)

assert(math.random(5 / 2) <= 2)
assert(string.format('%03d|%5.2f|%d%%|%s', 2.7, 1 / 3, -1.5, 'x') == '002| 0.33|-1%|x')
assert(not pcall(string.format, '%d', 'x') and not pcall(string.format, '%d') and not pcall(string.format))
assert(('%d'):format(7.9) == '7')

-- modules of 5.1, and of 5.0 with the .lua written out
require 'parts.colours'
assert(parts.colours.red[1] == 1 and parts.colours.mix(0.5) == 0.25)
assert(colours_loaded == nil, 'globals of a module stay in the module')
assert(require('parts.colours') == parts.colours)
require('parts/shades.lua')
assert(shade(2) == 4)

-- environments
local function asks() return secret end
setfenv(asks, {secret = 'kept'})
assert(asks() == 'kept' and secret == nil)
assert(getfenv(asks).secret == 'kept')
assert(getfenv(1) == _G)
