-- Functions of the kinds that students write: most are recorded with the bits of Lua, the others have an error that
-- names the line and the reason.
local claims = require 'claims'
local recorded, refused = {}, {}
local function records(name, f) recorded[#recorded + 1] = { name, f } end
local function refuses(name, words, f)
    refused[#refused + 1] = { name, f, words, debug.getinfo(2, 'l').currentline }
end

records('fbm while', function(p)
    local sum, amp, freq, i = 0, 0.5, 1, 0
    while i < 6 do
        sum = sum + amp * gr.noise(p.x * freq, p.y * freq, p.z * freq)
        amp, freq, i = amp * 0.5, freq * 2.02, i + 1
    end
    return 0.5 + 0.5 * sum
end)
records('domain warp', function(p)
    local function fbm(x, y, z) local s = 0 for o = 0, 3 do s = s + gr.noise(x * 2^o, y * 2^o, z * 2^o) / 2^o end return s end
    local qx, qy = fbm(p.x, p.y, p.z), fbm(p.x + 5.2, p.y + 1.3, p.z)
    local rx, ry = fbm(p.x + 4 * qx + 1.7, p.y + 4 * qy + 9.2, p.z), fbm(p.x + 4 * qx + 8.3, p.y + 4 * qy + 2.8, p.z)
    local v = fbm(p.x + 4 * rx, p.y + 4 * ry, p.z)
    return {v * v, math.abs(qx), ry ^ 2}
end)
records('voronoi ints', function(p)
    local ix, iy = math.floor(p.x), math.floor(p.y)
    local best = math.huge
    for dx = -1, 1 do
        for dy = -1, 1 do
            local cx, cy = ix + dx, iy + dy
            local h = (cx * 73856093) ~ (cy * 19349663)
            h = (h ~ (h >> 7)) & 0xffff
            local px, py = cx + (h & 0xff) / 255, cy + (h >> 8) / 255
            local d = (p.x - px) ^ 2 + (p.y - py) ^ 2
            if d < best then best = d end
        end
    end
    return math.sqrt(best)
end)
records('voronoi min', function(p)
    local ix, iy = math.floor(p.x), math.floor(p.y)
    local best = math.huge
    for dx = -1, 1 do for dy = -1, 1 do
        local cx, cy = ix + dx, iy + dy
        local h = gr.hash(cx, cy, 0)
        best = math.min(best, (p.x - cx - h) ^ 2 + (p.y - cy - h) ^ 2)
    end end
    return best ^ 0.5
end)
refuses('string.format', [[bad argument #2 to 'format' (number expected, got recorded number)]],
    function(p) return tonumber(string.format('%.2f', p.x)) end)
refuses('concat', [[attempt to concatenate a recorded number value (field 'x')]], function(p) return #('x' .. p.x) end)
refuses('tostring', [[it must depend only on its arguments]], function(p) return #tostring(p.x) end)
records('table.sort', function(p)
    local t = {p.x, p.y, p.z}
    table.sort(t)
    return t[2]
end)
records('table.sort function', function(p)
    local t = {p.x, p.y, p.z}
    table.sort(t, function(a, b) return a > b end)
    return t[1] - t[3]
end)
records('sort 6', function(p)
    local t = {p.x, p.y, p.z, p.x * 2, p.y * 3, p.z + 1}
    table.sort(t)
    return t[3]
end)
local V = {}
V.__index = V
V.__add = function(a, b) return setmetatable({x = a.x + b.x, y = a.y + b.y}, V) end
V.__mul = function(a, b) if type(a) == 'number' then a, b = b, a end return setmetatable({x = a.x * b, y = a.y * b}, V) end
V.__len = function(a) return math.sqrt(a.x * a.x + a.y * a.y) end
V.__eq = function(a, b) return a.x == b.x and a.y == b.y end
V.__lt = function(a, b) return a.x < b.x end
V.__unm = function(a) return setmetatable({x = -a.x, y = -a.y}, V) end
V.__call = function(self, k) return self.x * k end
local function v2(x, y) return setmetatable({x = x, y = y}, V) end
records('metatables', function(p)
    local a, b = v2(p.x, p.y), v2(p.z, 1)
    local c = a + b * 2 + -b
    return #c + c(0.5)
end)
records('metatables number first', function(p) local a = 2 * v2(p.x, p.y) return a.x + a.y end)
records('metatables symbol first', function(p) local a = p.z * v2(p.x, p.y) return a.x + a.y end)
records('metatables lt eq', function(p)
    local a, b = v2(p.x, p.y), v2(p.y, p.x)
    if a < b then return 1 elseif a == b then return 2 else return 3 end
end)
local function sum(...)
    local s = 0
    for i = 1, select('#', ...) do s = s + (select(i, ...)) end
    return s
end
records('varargs', function(p) return sum(p.x, p.y, p.z, 1, 2) end)
records('varargs pack', function(p)
    local function mean(...) local t = table.pack(...) local s = 0 for i = 1, t.n do s = s + t[i] end return s / t.n end
    return mean(p.x, p.y, p.z)
end)
records('goto', function(p)
    local n, x = 0, p.x
    ::again::
    if x > 1 then x = x / 2 n = n + 1 if n < 8 then goto again end end
    for i = 1, 5 do
        if i == 3 then goto continue end
        n = n + i * p.y
        ::continue::
    end
    return n + x
end)
records('int division', function(p)
    local a, b = math.floor(p.x * 8) // 3, math.floor(p.y * 8) % 5
    return (a * 5 + b) / 7 + (a // -2) + (-a) % 3
end)
records('float division ints', function(p) return p.x // 1 + p.y // 0.5 % 2 + (p.z % -3) end)
records('bits', function(p)
    local x, y = math.floor(p.x * 16) & 255, math.floor(p.y * 16) & 255
    return ((x ~ y) & (x | y << 1) >> 1) / 255 + (~x & 0xf)
end)
records('bits of floats', function(p) return (p.x // 1 & 7) / 7 end)
refuses('bits of a fraction', [[number (field 'x') has no integer representation]],
    function(p) return (p.x & 7) / 7 end)
records('coroutine producer', function(p)
    local gen = coroutine.wrap(function() for i = 1, 4 do coroutine.yield(i * p.x) end end)
    local s = 0
    for v in gen do s = s + v end
    return s
end)
records('coroutine branch', function(p)
    local co = coroutine.create(function(a) if a > 0 then local b = coroutine.yield(a) return b * 2 end return p.y end)
    local _, v = coroutine.resume(co, p.x)
    local _, w = coroutine.resume(co, v)
    return type(w) == 'number' and w or v
end)
records('pcall error', function(p)
    local ok, v = pcall(function() if p.x < 0 then error('negative') end return math.sqrt(p.x) end)
    return ok and v or 0
end)
records('pcall error table', function(p)
    local ok, e = pcall(function() if p.x < 0 then error({code = 3}) end return 1 end)
    return ok and 1 or e.code
end)
records('pcall string arithmetic',
    function(p) local ok = pcall(function() return p.x + {} end) return ok and 1 or 0.5 end)
records('xpcall', function(p)
    local ok, v = xpcall(function() if p.y > 0.5 then error('x') end return p.y end, function(m) return -1 end)
    return ok and v or v * 2
end)
records('recursion by depth', function(p)
    local function cantor(x, depth)
        if depth == 0 then return 1 end
        if x < 0 or x > 1 then return 0 end
        if x < 1 / 3 then return cantor(3 * x, depth - 1) end
        if x > 2 / 3 then return cantor(3 * x - 2, depth - 1) end
        return 0
    end
    return cantor(p.x, 4)
end)
records('mutual recursion', function(p)
    local even, odd
    function even(n, x) if n == 0 then return x end return odd(n - 1, x * x) end
    function odd(n, x) if n == 0 then return -x end return even(n - 1, x + 1) end
    return even(5, p.x)
end)
refuses('recursion symbol', [[the function has more than 100000 operations]], function(p)
    local function fact(n) if n <= 1 then return 1 end return n * fact(n - 1) end
    return fact(math.floor(p.x))
end)
refuses('random', [[it must depend only on its arguments]], function(p) return math.random() end)
refuses('random int', [[it must depend only on its arguments]], function(p) return p.x + math.random(10) end)
refuses('randomseed of symbol', [[bad argument #1 to 'randomseed' (number expected, got recorded number)]],
    function(p) math.randomseed(math.floor(p.x)) return math.random() end)
refuses('clock', [[it must depend only on its arguments]], function(p) return os.clock() end)
records('nested early return', function(p)
    for i = 1, 3 do
        for j = 1, 3 do
            if (p.x - i) ^ 2 + (p.y - j) ^ 2 < 0.16 then return {i / 3, j / 3, 0} end
        end
    end
    return 0
end)
records('while symbol', function(p)
    local x, n = math.abs(p.x), 0
    while x > 1 do x = x - 1 n = n + 1 if n >= 50 then break end end
    return x + n / 100
end)
refuses('while symbol unbounded', [[a call of the function branches more than 4096 times on its arguments]], function(p)
    local x = math.abs(p.x)
    while x > 1 do x = x - 1 end
    return x
end)
records('repeat halving', function(p)
    local x, n = math.abs(p.x) + 1, 0
    repeat x = x / 2 n = n + 1 until x < 0.5 or n == 12
    return n
end)
records('~= symbols', function(p) if math.floor(p.x) ~= math.floor(p.y) then return 1 end return 0 end)
refuses('~= number', [[it must depend only on its arguments]],
    function(p) if math.floor(p.x) % 2 ~= 0 then return 1 end return 0 end)
refuses('== number', [[it must depend only on its arguments]],
    function(p) if math.floor(p.x) % 2 == 0 then return 1 end return 0 end)
records('x == 0 unreached', function(p) if p.x == 0.123456 then return 1 end return 0 end)
records('not symbol', function(p) return not p.x and 1 or 0 end)
records('not comparison', function(p) if not (p.x < 0.3) then return p.y end return p.z end)
records('truth arithmetic', function(p) local b = p.x > 0 return (b and 1 or 0) + (not b and 2 or 0) end)
records('compare booleans', function(p) return ((p.x > 0) == (p.y > 0)) and 1 or 0 end)
records('swap', function(p)
    local a, b, c = p.x, p.y, p.z
    if a > b then a, b = b, a end
    if b > c then b, c = c, b end
    if a > b then a, b = b, a end
    return {a, b, c}
end)
records('unpack', function(p) local x, y, z = table.unpack(p) return x * y * z end)
records('unpack symbols', function(p) return math.max(table.unpack({p.x, p.y, p.z})) end)
records('ipairs of point', function(p) local s = 0 for _, v in ipairs(p) do s = s + v * v end return s end)
records('pairs of point', function(p) local s = 0 for k, v in pairs(p) do s = s + v end return s end)
records('#p', function(p) return #p + p.x end)
local palette = {red = {1, 0, 0}, green = {0, 1, 0}, blue = {0, 0, 1}}
records('string keys', function(p)
    local key = p.x < -0.3 and 'red' or p.x < 0.3 and 'green' or 'blue'
    return palette[key]
end)
local list = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 0}}
refuses('colour table index', [[the function must return a number or a colour {r, g, b}, not nil]],
    function(p) return list[math.floor(p.x * 4) % 4 + 1] end)
records('colour table index loop', function(p)
    local i = math.floor(p.x * 4) % 4
    for k = 1, 4 do if i >= k - 1 and i <= k - 1 then return list[k] end end
    return 0
end)
records('colour table lookup', function(p) return gr.lookup(list, math.floor(p.x * 4) % 4 + 1) end)
records('table key symbol write', function(p) local t = {} t[p.x] = 1 return t[p.x] end)
refuses('table key int symbol write', [[it must depend only on its arguments]],
    function(p) local t = {0, 0, 0} t[math.floor(p.x) % 3 + 1] = 1 return t end)
refuses('memo', [[it must depend only on its arguments]],
    (function() local memo = {} return function(p) local v = memo[p.x] if not v then v = math.sin(p.x) memo[p.x] = v end return v end end)())
records('memo by string',
    (function() local memo = {} return function(p) local k = tostring(p.x) memo[k] = memo[k] or math.sin(p.x) return memo[k] end end)())
records('select #', function(p, ...) return select('#', ...) + p.x end)
records('select negative', function(p) return (select(-1, p.x, p.y)) end)
refuses('select symbol', [[bad argument #1 to 'select' (number expected, got recorded number)]],
    function(p) return (select(math.floor(p.x) % 2 + 1, 0.25, 0.75)) end)
refuses('global counter', [[it must depend only on its arguments]],
    function(p) counter = (counter or 0) + 1 return counter * p.x end)
refuses('upvalue last', [[a number of a recorded function is used outside the function]],
    (function() local last = 0 return function(p) local r = last last = p.x return r end end)())
refuses('modify p', [[the fields of a vector cannot be set]], function(p) p.x = p.x * 2 return p.x end)
records('modify p index', function(p) p[1] = 0 return p.x + p.y end)
records('modify s', function(p, s) s.u = 0.5 return s.u end)
refuses('p.xy', [[the function must return a number or a colour {r, g, b}, not nil]], function(p) return p.xy end)
refuses('p.w', [[attempt to perform arithmetic on a nil value (field 'w')]], function(p) return p.w * 2 end)
refuses('s.uv', [[attempt to perform arithmetic on a nil value (field 'uv')]], function(p, s) return s.uv * 2 end)
refuses('p:len', [[attempt to call a nil value (method 'len')]], function(p) return p:len() end)
refuses('missing math', [[attempt to call a nil value (field 'sine')]], function(p) return math.sine(p.x) end)
refuses('lerp global', [[attempt to call a nil value (global 'lerp')]], function(p) return lerp(0, 1, p.x) end)
records('math.round', function(p) return math.floor(p.x + 0.5) end)
records('math.pow', function(p) return math.pow(p.x, 2) + math.cosh(p.y) end)
records('math.huge', function(p) return math.min(math.huge, p.x) + math.max(-math.huge, p.y) end)
records('math.pi integer', function(p) return math.maxinteger // 1 * 0 + math.mininteger * 0 + p.x end)
records('fmod', function(p) return math.fmod(p.x, 1) + math.fmod(p.y, -0.7) end)
records('modf', function(p) local i, f = math.modf(p.x * 3) return f + i / 10 end)
refuses('frexp', [[math.frexp cannot be recorded]], function(p) local m, e = math.frexp(p.x) return m + e end)
refuses('ldexp', [[math.ldexp cannot be recorded]], function(p) return math.ldexp(p.x, 3) end)
records('tointeger', function(p) return (math.tointeger(p.x) or 7) + 0.5 end)
records('math.type', function(p) return math.type(p.x) == 'float' and 1 or 0 end)
records('type check', function(p) if type(p.x) ~= 'number' then error('no number') end return p.x end)
records('assert', function(p) assert(p.x, 'no x') assert(type(p) == 'table', 'p is a ' .. type(p)) return p.x end)
records('assert comparison', function(p) assert(p.x > -1e9) return p.x end)
records('tonumber', function(p) return tonumber(p.x) * 2 end)
records('tonumber base', function(p) return tonumber('ff', 16) / 255 * p.x end)
records('rawequal', function(p) return rawequal(p.x, p.x) and 1 or 0 end)
records('rawget', function(p) return rawget(p, 'x') or rawget(p, 1) or 0 end)
refuses('string of symbols', [[attempt to concatenate a recorded number value (field 'x')]],
    function(p) return p.x .. '' end)
refuses('string rep', [[bad argument #2 to 'rep' (number expected, got recorded number)]],
    function(p) return #string.rep('a', math.floor(p.x)) end)
records('utf8', function(p) return utf8.char(65) == 'A' and p.x or 0 end)

records('load', function(p) return load('return 2')() * p.x end)
records('require', function(p) return require('easing').out_quad(p.x) end)
records('closure per call',
    function(p) local fs = {} for i = 1, 4 do fs[i] = function(x) return x * i end end local s = 0 for _, f in ipairs(fs) do s = s + f(p.x) end return s end)
records('curry', function(p) local function add2(a) return function(b) return a + b end end return add2(p.x)(p.y) end)
refuses('string method number', [[an operator on a number of the recorded function needs another number, not a string]],
    function(p) return ('%d'):format(3) * p.x end)
refuses('compare with string', [[an operator on a number of the recorded function needs another number, not a string]],
    function(p) return p.x < '1' and 1 or 0 end)
refuses('compare nil', [[an operator on a number of the recorded function needs another number, not nil]],
    function(p) return p.x < nil and 1 or 0 end)
refuses('return nothing on a path', [[the function returns 0 values, not a number or a colour {r, g, b}]],
    function(p) if p.x < 0 then return 1 end end)
refuses('return boolean', [[the function must return a number or a colour {r, g, b}, not a boolean]],
    function(p) return p.x < 0 end)
refuses('return nested', [[the function must return a number or a colour {r, g, b}, not a table]],
    function(p) return {{p.x, p.y, p.z}} end)
refuses('return rgb fields', [[the function must return a number or a colour {r, g, b}, not a table]],
    function(p) return {r = p.x, g = p.y, b = p.z} end)
refuses('return four', [[the function must return a number or a colour {r, g, b}, not a table]],
    function(p) return {p.x, p.y, p.z, 1} end)
refuses('return three values', [[the function returns 3 values, not a number or a colour {r, g, b}]],
    function(p) return p.x, p.y, p.z end)
records('mixed returns',
    function(p) if p.x < 0 then return 0.5 elseif p.x < 0.5 then return {1, 0, 0} else return gr.vec(p) end end)
records('nan', function(p) return 0 / 0 * p.x end)
records('inf', function(p) return 1 / 0 end)
records('sqrt negative', function(p) return math.sqrt(p.x) end)
refuses('int divide zero', [[attempt to divide by zero]], function(p) return 1 // math.floor(p.x) end)
refuses('int modulo zero', [[attempt to perform 'n%0']], function(p) return 5 % (math.floor(p.x) * 0) end)
records('for step', function(p) local s = 0 for i = 10, 1, -3 do s = s + i * p.x end return s end)
records('for float', function(p) local s = 0 for t = 0, 1, 0.25 do s = s + math.abs(p.x - t) end return s end)
refuses('for symbol start', [[bad 'for' initial value (number expected, got recorded number)]],
    function(p) local s = 0 for i = math.floor(p.x), 10 do s = s + i end return s end)
records('numeric for break',
    function(p) local s = 0 for i = 1, 20 do s = s + 1 / i if s > p.x then break end end return s end)
refuses('gcd unbounded', [[a call of the function branches more than 4096 times on its arguments]], function(p)
    local a, b = math.abs(math.floor(p.x * 10)), math.abs(math.floor(p.y * 10))
    while b > 0 do a, b = b, a % b end
    return a / 10
end)
records('gcd 8', function(p)
    local a, b = math.floor(p.x) & 7, math.floor(p.y) & 7
    for _ = 1, 5 do if b > 0 then a, b = b, a % b end end
    return a
end)
records('lcg', function(p)
    local seed = math.floor(p.x * 100) ~ (math.floor(p.y * 100) << 8)
    for _ = 1, 4 do seed = (seed * 6364136223846793005 + 1442695040888963407) end
    return (seed >> 33) / 2147483648
end)
records('xorshift', function(p)
    local x = math.floor(p.x) + 1
    x = x ~ (x << 13) x = x ~ (x >> 7) x = x ~ (x << 17)
    return (x & 0xfffffff) / 0xfffffff
end)
records('sdf scene', function(p)
    local function box(q, b) local d = gr.vec(math.abs(q.x) - b, math.abs(q.y) - b, math.abs(q.z) - b)
        return gr.length(gr.max(d, 0)) + math.min(math.max(d.x, math.max(d.y, d.z)), 0) end
    local function smin(a, b, k) local h = math.max(k - math.abs(a - b), 0) / k return math.min(a, b) - h * h * k / 4 end
    return smin(box(p, 0.5), gr.length(p) - 0.6, 0.1)
end)
records('rotate',
    function(p) local a = math.rad(30) local c, s = math.cos(a), math.sin(a) return math.sin(5 * (c * p.x - s * p.z)) end)
records('polar',
    function(p) local r, a = math.sqrt(p.x ^ 2 + p.y ^ 2), math.atan2 and math.atan2(p.y, p.x) or math.atan(p.y, p.x) return math.sin(10 * r + a) end)
refuses('hsv own', [[the function must return a number or a colour {r, g, b}, not nil]], function(p)
    local h = p.x % 1 * 6
    local i = math.floor(h)
    local f = h - i
    local t = {{1, f, 0}, {1 - f, 1, 0}, {0, 1, f}, {0, 1 - f, 1}, {f, 0, 1}, {1, 0, 1 - f}}
    return t[i + 1]
end)
refuses('hsv own if', [[it must depend only on its arguments]], function(p)
    local h = p.x % 1 * 6
    local i = math.floor(h)
    local f = h - i
    if i == 0 then return {1, f, 0} elseif i == 1 then return {1 - f, 1, 0} elseif i == 2 then return {0, 1, f}
    elseif i == 3 then return {0, 1 - f, 1} elseif i == 4 then return {f, 0, 1} end
    return {1, 0, 1 - f}
end)
records('hsv own <', function(p)
    local h = p.x % 1 * 6
    local f = h % 1
    if h < 1 then return {1, f, 0} elseif h < 2 then return {1 - f, 1, 0} elseif h < 3 then return {0, 1, f}
    elseif h < 4 then return {0, 1 - f, 1} elseif h < 5 then return {f, 0, 1} end
    return {1, 0, 1 - f}
end)
records('brick', function(p)
    local row = math.floor(p.y * 4)
    local x = p.x * 2
    if row % 2 >= 1 then x = x + 0.5 end
    local fx, fy = x % 1, p.y * 4 % 1
    return (fx < 0.05 or fy < 0.1) and {0.7, 0.7, 0.7} or {0.6, 0.2, 0.1}
end)
refuses('game of life-ish table', [[the function has more than 4096 paths]], function(p)
    local grid = {}
    for i = 1, 4 do grid[i] = {} for j = 1, 4 do grid[i][j] = math.sin(i * p.x + j * p.y) > 0 end end
    local n = 0
    for i = 1, 2 do for j = 1, 2 do if grid[i][j] then n = n + 1 end end end
    return n / 4
end)
refuses('table.concat', [[invalid value (userdata) at index 1 in table for 'concat']],
    function(p) return #table.concat({p.x, p.y}, ',') end)
records('table.insert',
    function(p) local t = {} table.insert(t, p.x) table.insert(t, 1, p.y) table.remove(t) return t[1] end)
records('table.move', function(p) local t = table.move({p.x, p.y, p.z}, 1, 3, 2, {0}) return t[2] + t[4] end)
records('next', function(p) local t = {a = p.x} local k, v = next(t) return v end)
records('getmetatable', function(p) return getmetatable(p.x) and 1 or 0 end)
refuses('setmetatable symbol', [[bad argument #1 to 'setmetatable' (table expected, got recorded number)]],
    function(p) return setmetatable(p.x, {}) end)
records('string.len of type', function(p) return #type(p.x) * p.x end)
refuses('gr.render inside', [[gr.render cannot be called by a function that is recorded]],
    function(p) gr.render{} return 1 end)
refuses('gr.fn inside', [[gr.fn cannot be called by a function that is recorded]],
    function(p) return gr.fn(function(q) return q.x end) end)
records('gr.noise table', function(p) return gr.noise({p.x, p.y, p.z}) + gr.noise{p.x * 2, 0, 0} end)
refuses('noise two args', [[bad argument #3 to 'noise' (a number or a vector is needed)]],
    function(p) return gr.noise(p.x, p.y) end)
records('vec in table of table',
    function(p) local m = {gr.vec(1,0,0), gr.vec(0,1,0), gr.vec(0,0,1)} local q = gr.vec(m[1]:dot(p), m[2]:dot(p), m[3]:dot(p)) return q end)
records('ternary false', function(p) return p.x > 0 and false or 1 end)
records('and chain numbers', function(p) return p.x and p.y and p.z end)
records('or chain', function(p) return nil or p.x end)
records('integer overflow', function(p) return (math.floor(p.x) + math.maxinteger) % 1000 end)
records('shift by symbol', function(p) return (1 << (math.floor(p.x) & 15)) / 32768 end)
records('power int', function(p) return 2 ^ math.floor(p.x) + math.floor(p.y) ^ 0.5 end)
records('unary', function(p) return -(-p.x) + - -1 end)
records('shadowed math', function(p) local math = {sin = function(x) return x end} return math.sin(p.x) end)
refuses('string index', [[an operator on a number of the recorded function needs another number, not nil]],
    function(p) return p['x'] + p['1'] end)
records('deep tail recursion',
    function(p) local function go(n, x) if n == 0 then return x end return go(n - 1, x * 0.999 + p.y) end return go(5000, p.x) end)
records('collatz',
    function(p) local n, k = math.floor(math.abs(p.x)) + 1, 0 while n > 1 and k < 10 do if n % 2 < 1 then n = n // 2 else n = 3 * n + 1 end k = k + 1 end return k end)
records('newton fractal', function(p)
    local x, y = p.x, p.y
    for _ = 1, 6 do
        local d = 3 * (x * x + y * y) ^ 2
        local nx = x - (x ^ 5 + 2 * x ^ 3 * y ^ 2 - x ^ 2 + x * y ^ 4 + y ^ 2) / d
        y = y - y * (x ^ 4 + 2 * x * x * y * y + 2 * x + y ^ 4) / d
        x = nx
    end
    return x > 0 and {1, 0, 0} or y > 0 and {0, 1, 0} or {0, 0, 1}
end)

claims.claim('functions of students are recorded as Lua computes them', function()
    for _, entry in ipairs(recorded) do
        local good, why = pcall(gr.fn, entry[2])
        assert(good, ('%s: %s'):format(entry[1], why))
    end
    assert(#recorded > 100, #recorded)
end)

claims.claim('other functions of students are errors with the line and the reason', function()
    for _, entry in ipairs(refused) do
        local good, why = pcall(gr.fn, entry[2])
        assert(not good, entry[1])
        why = tostring(why)
        assert(why:find(entry[3], 1, true), ('%s: %s'):format(entry[1], why))
        local line = tonumber(why:match 'the function of line (%d+)' or why:match ': f: .-:(%d+): ')
        assert(line and line >= entry[4] and line < entry[4] + 15, ('%s: not its line: %s'):format(entry[1], why))
    end
    assert(#refused > 40, #refused)
end)
