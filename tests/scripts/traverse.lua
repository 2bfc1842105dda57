-- The order of pairs is fixed: 1..n, other numbers, booleans, strings, handles by age.
local a, b = gr.node('a'), gr.node('b')
local t = {30, 10, 20, zebra = 1, apple = 2, [''] = 3, [-1] = 4, [2.5] = 5, [100] = 6, [b] = 7, [a] = 8, [true] = 9, [false] = 10}
local order = {}
for key, value in pairs(t) do order[#order + 1] = tostring(key) .. '=' .. value end
assert(table.concat(order, ' ') ==
    "1=30 2=10 3=20 -1=4 2.5=5 100=6 false=10 true=9 =3 apple=2 zebra=1 node 'a'=8 node 'b'=7")

-- entries may be changed and removed during the traversal
local seen = 0
local u = {x = 1, y = 2, z = 3, 1, 2, 3}
for key in pairs(u) do
    seen = seen + 1
    u.z, u[3] = nil, nil
    if u[key] then u[key] = 5 end
end
assert(seen == 4)
for key in pairs(u) do u[key] = nil end
assert(next(u) == nil)

-- a pure sequence, an empty table, nested traversals, __pairs
local sum = 0
for index, value in pairs({5, 6, 7}) do sum = sum + index * value end
assert(sum == 5 + 12 + 21)
for _ in pairs({}) do error('nothing is in it') end
local inner = 0
for _ in pairs({a = 1, b = 2}) do for _ in pairs({c = 1, d = 2}) do inner = inner + 1 end end
assert(inner == 4)
local odd = setmetatable({}, {__pairs = function() return function(_, k) if not k then return 1, 'one' end end, nil, nil end})
for key, value in pairs(odd) do assert(key == 1 and value == 'one') end
assert(not pcall(pairs, nil))

-- many keys
local many, last, count = {}, '', 0
for i = 1, 3000 do many['k' .. (i * 7919) % 3000] = i end
for key in pairs(many) do
    assert(last < key)
    last, count = key, count + 1
end
assert(count == 3000)

-- functions that untrusted scripts must not have
assert(os.execute == nil and io.popen == nil and package.loadlib == nil and debug.sethook == nil)
assert(debug.getinfo(1, 'S').source:sub(1, 1) == '@' and debug.getinfo(1, 'S').source:match('traverse%.lua$'))
assert(type(debug.traceback('x')) == 'string')
assert(load(string.dump(function() end)) == nil)
assert(getmetatable(a) == 'node' and not pcall(setmetatable, gr, {}))
assert(require 'gr' == gr and gr.version)

-- files in the script's folder
local handle = assert(io.open('parts/shades.lua'))
handle:close()
assert(io.open('nowhere') == nil)
