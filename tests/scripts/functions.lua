-- Functions as they are written in a course, without knowledge of how they are recorded: each is recorded, and so
-- compared with Lua at 1,000 points, or refused with a line that names the reason.
local refusals = {
  ['format'] = "it cannot become text",
  ['concat'] = "it cannot become text",
  ['forsym'] = "bad 'for' limit",
  ['counter2'] = "it must depend only on its arguments",
  ['=='] = "x == 0 cannot be recorded",
  ['x~=x'] = "it gives 1, recorded 0",
  ['index'] = "use gr.lookup(t, i)",
  ['indexset'] = "t[x] = y",
  ['hex'] = "not a string",
  ['strindex'] = "choose an argument",
  ['selectsym'] = "choose an argument",
  ['setp'] = "make another vector with gr.vec",
  ['makenode'] = "gr.sphere cannot be called",
  ['random'] = "it must depend only on its arguments",
  ['intdiv0'] = "attempt to divide by zero",
  ['nothing'] = "the function returns 0 values",
  ['memo'] = "t[x] = y",
  ['gcd'] = "branches more than 4096 times",
  ['hsv =='] = "x == 0 cannot be recorded",
}
local count = 0
local function add(name, f)
  local good, why = pcall(gr.fn, f)
  count = count + 1
  if refusals[name] then
    assert(not good and why:find(refusals[name], 1, true) and why:find(':%d+: '), name .. ': ' .. tostring(why))
  else
    assert(good, name .. ': ' .. tostring(why))
  end
end

local palette = {grass = {0.2,0.6,0.1}, rock = {0.5,0.5,0.5}, snow = {1,1,1}}
add('palette', function(p) local k = p.y > 0.7 and 'snow' or p.y > 0.2 and 'rock' or 'grass' return palette[k] end)
local function waves(p, ...) local s = 0 for i, w in ipairs{...} do s = s + math.sin(p.x * w) / i end return s end
add('varargs', function(p) return waves(p, 1, 2, 4, 8) * 0.5 + 0.5 end)
local function avg(...) local n = select('#', ...) local t = 0 for i = 1, n do t = t + (select(i, ...)) end return t / n end
add('selectn', function(p) return avg(p.x, p.y, p.z, 1) end)
local V = {} V.__index = V
function V.new(x, y) return setmetatable({x = x, y = y}, V) end
V.__add = function(a, b) return V.new(a.x + b.x, a.y + b.y) end
V.__mul = function(a, k) return V.new(a.x * k, a.y * k) end
V.__unm = function(a) return V.new(-a.x, -a.y) end
V.__len = function(a) return math.sqrt(a.x * a.x + a.y * a.y) end
V.__eq = function(a, b) return a.x == b.x and a.y == b.y end
V.__lt = function(a, b) return #a < #b end
V.__call = function(a, t) return a.x + t * (a.y - a.x) end
V.__tostring = function(a) return '(' .. a.x .. ',' .. a.y .. ')' end
V.__concat = function(a, b) return V.new(a.x, b.y) end
add('class', function(p) local a = V.new(p.x, p.y) + V.new(1, 2) * p.z local b = -a if a < b then return 1 end return a(0.25) + #b end)
add('class2', function(p) local a = V.new(p.x, p.y) .. V.new(p.z, 3) return a.y + a.x end)
add('coroutine', function(p) local co = coroutine.wrap(function() for i = 1, 4 do coroutine.yield(p.x * i) end end) local s = 0 for i = 1, 4 do s = s + co() end return s end)
add('coroutine2', function(p) local co = coroutine.create(function(a) local b = coroutine.yield(a * 2) if b > 0 then return b end return -b end) local _, x = coroutine.resume(co, p.x) local _, y = coroutine.resume(co, p.y) return x + y end)
add('pcall', function(p) local ok, v = pcall(function() if p.x > 0.5 then error('big') end return p.x end) return ok and v or 0.5 end)
add('pcall2', function(p) local ok, e = pcall(error, {code = 3}) return e.code * p.x end)
add('format', function(p) local s = string.format('%.2f', p.x) return tonumber(s) end)
add('format2', function(p) local names = {} for i = 1, 3 do names[string.format('k%d', i)] = p[i] end return names.k1 + names.k3 end)
add('concat', function(p) local s = 'v' .. p.x return #s end)
add('goto', function(p) local s = 0 for i = 1, 10 do if i % 3 == 0 then goto cont end s = s + math.cos(p.x * i) ::cont:: end return s / 10 end)
add('bits', function(p) local i = math.floor(p.x * 8) // 2 local j = math.floor(p.y * 8) local h = (i * 73856093) ~ (j * 19349663) h = h & 0xffff return h / 65535 end)
add('bits2', function(p) local x = math.floor(p.x * 100) x = (x ~ (x >> 3)) * 0x45d9f3b x = x ~ (x << 5) return (x & 255) / 255 end)
local function compose(...) local fs = {...} return function(x) for _, f in ipairs(fs) do x = f(x) end return x end end
add('closures', function(p) local f = compose(math.sin, math.abs, function(x) return x * x end) return f(p.x * 3) end)
add('tinsert', function(p) local t = {} for i = 1, 5 do table.insert(t, p.x * i) end table.insert(t, 1, p.y) local s = 0 for i = 1, #t do s = s + t[i] end return s end)
add('unpack', function(p) local t = {p.x, p.y, p.z} return math.max(table.unpack(t)) end)
add('tremove', function(p) local t = {p.x, p.y, p.z} return table.remove(t) + table.remove(t, 1) end)
add('tconcat', function(p) return #table.concat({'a', 'b'}, ',') * p.x end)
add('tsort', function(p) local t = {p.x, p.y, p.z} table.sort(t) return t[2] end)
add('tsort2', function(p) local t = {p.x, p.y, p.z} table.sort(t, function(a, b) return a > b end) return {t[1], t[2], t[3]} end)
add('fmod', function(p) return math.fmod(p.x * 5, 1) end)
add('fmod2', function(p) return math.fmod(math.floor(p.x), 4) end)
add('tointeger', function(p) return math.tointeger(math.floor(p.x)) % 2 end)
add('tointeger2', function(p) local i = math.tointeger(p.x) if i then return i end return 0.5 end)
add('ult', function(p) if math.ult(math.floor(p.x), 3) then return 1 end return 0 end)
add('modf', function(p) local i, f = math.modf(p.x) return f + i / 10 end)
add('mtype', function(p) return math.type(p.x) == 'float' and 1 or 0 end)
add('huge', function(p) local best = math.huge for i = 1, 5 do local d = (p - gr.vec(i, 0, 0)):length() if d < best then best = d end end return best end)
add('random', function(p) return math.random() end)
local function fbm(p, n) if n == 0 then return 0 end return gr.noise(p) + 0.5 * fbm(p * 2, n - 1) end
add('fbm', function(p) return fbm(p, 5) end)
local function fact(n) return n <= 1 and 1 or n * fact(n - 1) end
add('fact', function(p) return math.sin(p.x * fact(5)) end)
local function ack(x, d) if x > 10 then return x end return ack(x * 2 + 1, d + 1) end
add('recdata', function(p) return ack(math.abs(p.x), 0) end)
local function sierp(x, y, d) if d == 0 then return 1 end if x < 0.5 and y < 0.5 then return sierp(x*2, y*2, d-1) elseif x >= 0.5 and y >= 0.5 then return 0 else return sierp((x*2)%1, (y*2)%1, d-1) end end
add('sierpinski', function(p, s) return sierp(s.u, s.v, 4) end)
add('while', function(p) local x, n = p.x, 0 while n < 20 and math.abs(x) < 2 do x = x * x - 0.7 n = n + 1 end return n / 20 end)
add('repeat', function(p) local x, n = p.x, 0 repeat x = x * 0.5 n = n + 1 until x < 0.1 or n > 10 return n / 10 end)
add('mandel', function(p) local x, y = 0, 0 for i = 1, 30 do x, y = x*x - y*y + p.x, 2*x*y + p.y if x*x + y*y > 4 then return i / 30 end end return 0 end)
add('forsym', function(p) local s = 0 for i = 1, math.floor(p.x * 5) do s = s + i end return s end)
add('forfloat', function(p) local s = 0 for x = 0, 1, 0.25 do s = s + gr.smoothstep(x, x + 0.1, p.x) end return s end)
add('pairs', function(p) local c = {r = p.x, g = p.y} local s = 0 for k, v in pairs(c) do s = s + v end return s end)
add('next', function(p) local t = {a = p.x} local k, v = next(t) return v end)
local lights = {{pos = {1, 2, 3}, c = {1, 0, 0}}, {pos = {-1, 2, 0}, c = {0, 0, 1}}}
add('lights', function(p, s) local r = gr.vec(0, 0, 0) for _, l in ipairs(lights) do local d = gr.normalize(gr.vec(l.pos) - p) r = r + gr.vec(l.c) * gr.max(0, gr.dot(d, s.normal)) end return r end)
local memo = {}
add('memo', function(p) local k = p.x if memo[k] then return memo[k] end local v = math.sin(p.x) memo[k] = v return v end)
add('counter2', (function() local n = 0 return function(p) n = n + 1 return n / 1000 end end)())
add('==', function(p) if p.x == 0 then return 1 end return 0.5 end)
add('x~=x', function(p) local q = 0 / p.x * p.x if q ~= q then return 1 end return 0 end)
add('hex', function(p) return '#ff8800' end)
add('srgb', function(p) return gr.srgb(200, 100, 50) end)
add('index', function(p) local t = {0.1, 0.5, 0.9} return t[math.floor(p.x * 3) % 3 + 1] end)
add('indexset', function(p) local t = {} t[math.floor(p.x)] = 1 return t[1] or 0 end)
add('strindex', function(p) return ('abc'):byte(math.floor(p.x) % 3 + 1) / 255 end)
add('selectsym', function(p) return (select(math.floor(p.x) % 3 + 1, 1, 2, 3)) end)
add('len', function(p) return #p end)
add('setp', function(p) p.x = 3 return p.x end)
add('makenode', function(p) gr.sphere('x') return 1 end)
add('noargs', function() return 0.5 end)
add('nothing', function(p) if p.x > 0 then return 1 end end)
add('load', function(p) return load('return 3')() * p.x end)
add('assert', function(p) assert(p.x < 1e6, 'too large') return p.x end)
add('close', function(p) local t <close> = setmetatable({}, {__close = function() end}) return p.x end)
add('const', function(p) local k <const> = 3 return p.x * k end)
add('tonumber', function(p) return tonumber('0x10') * p.x + tonumber(p.y) end)
add('min3', function(p) return gr.min(p, gr.vec(0.5)) end)
add('smin', function(p) local a, b, k = p:length() - 1, (p - gr.vec(1,0,0)):length() - 0.5, 0.3 local h = gr.clamp(0.5 + 0.5 * (b - a) / k, 0, 1) return gr.mix(b, a, h) - k * h * (1 - h) end, 'solid')
add('rot', function(p) local c, s = math.cos(p.y), math.sin(p.y) local q = gr.vec(c * p.x - s * p.z, p.y, s * p.x + c * p.z) return gr.max(math.abs(q.x), math.abs(q.y), math.abs(q.z)) - 0.5 end, 'solid')
add('march', function(p, s) local t, d = 0.0, 0.0 for i = 1, 24 do d = ((p + s.view * t):length() - 0.8) if d < 0.001 then break end t = t + d end return t end)
add('march2', function(p, s) local t = 0.0 for i = 1, 8 do local q = p + s.view * t local d = math.min(q:length() - 0.8, q.y + 1) if d < 0.001 then return {1, 0, 0} end if t > 20 then return {0, 0, 1} end t = t + d end return gr.vec(t) end)
add('ternarychain', function(p) return p.x < -0.5 and 0 or p.x < 0 and 0.25 or p.x < 0.5 and 0.5 or 1 end)
add('intdiv', function(p) return (math.floor(p.x) // 3) % 2 end)
add('intdiv0', function(p) return 1 // math.floor(p.x) end)
add('fdiv0', function(p) return p.y / math.floor(p.x) end)
add('bigint', function(p) local h = math.floor(p.x * 1000) for i = 1, 5 do h = h * 6364136223846793005 + 1442695040888963407 end return (h >> 40) / (1 << 24) end)
add('shiftneg', function(p) return (math.floor(p.x) >> math.floor(p.y)) & 15 end)
add('neg0', function(p) return 1 / (p.x * 0) end)
add('upvalue matrix', (function() local m = {{1,0,0},{0,0,1},{0,1,0}} return function(p) local r = {} for i = 1, 3 do r[i] = 0 for j = 1, 3 do r[i] = r[i] + m[i][j] * p[j] end end return r end end)())
add('unpackp', function(p) local x, y, z = table.unpack(p) return x + y + z end)
add('ipairsp', function(p) local s = 0 for i, c in ipairs(p) do s = s + c * i end return s end)
add('packn', function(p) local t = table.pack(p.x, p.y, nil, p.z) return t.n + t[4] end)
add('move', function(p) local t = table.move({p.x, p.y, p.z}, 1, 3, 2, {9}) return t[1] * t[4] end)
add('math alias', function(p) local sin <const>, floor = math.sin, math.floor return sin(floor(p.x)) end)
add('queue', function(p) local q, s = {p.x}, 0 while #q > 0 and s < 5 do local v = table.remove(q, 1) s = s + 1 if v > 0.1 then q[#q + 1] = v / 2 end end return s end)
do  add('deep pcall', function(p) local ok, r = pcall(function() local t = {} return t[p.x].y end) return ok and r or p.y end) end
do  add('setv', function(p) local v = gr.vec(1, 2, 3) v[2] = p.y return v end) end
do local co  add('wrap leak', function(p) co = co or coroutine.wrap(function(x) while true do x = coroutine.yield(x * 2) end end) return co(p.x) end) end
do  add('mini //-1', function(p) local i = math.floor(p.x) return (math.mininteger // (i & 0 | -1)) + math.mininteger % -1 + i end) end
do  add('imod', function(p) return math.floor(p.x) % -3 + math.floor(p.y) // -2 end) end
do  add('fmodneg', function(p) return p.x % -0.7 + p.y // -0.3 + math.fmod(p.z, -0.4) end) end
do  add('shift64', function(p) local i = math.floor(p.x) return ((i << 64) | (i >> 63) | (i << -1)) & 0xff end) end
do local function a(m, n) if m == 0 then return n + 1 elseif n == 0 then return a(m - 1, 1) else return a(m - 1, a(m, n - 1)) end end  add('ack', function(p) return a(2, 3) * p.x end) end
do local Y = function(f) return (function(x) return x(x) end)(function(x) return f(function(...) return x(x)(...) end) end) end  add('y comb', function(p) return Y(function(s) return function(n) if n == 0 then return p.x end return s(n - 1) * 0.9 + 1 end end)(6) end) end
do local function mul(a, b) local c = {} for i = 1, 3 do c[i] = {} for j = 1, 3 do local s = 0 for k = 1, 3 do s = s + a[i][k] * b[k][j] end c[i][j] = s end end return c end  add('matrix', function(p) local c, s = math.cos(p.y), math.sin(p.y) local m = mul({{c, 0, s}, {0, 1, 0}, {-s, 0, c}}, {{1, 0, 0}, {0, c, -s}, {0, s, c}}) return {m[1][1], m[2][3], m[3][1]} end) end
do local t = {0.1, 0.3, 0.6, 0.8, 0.95}  add('binary search', function(p, s) local lo, hi = 1, #t + 1 while lo < hi do local mid = (lo + hi) // 2 if t[mid] < s.u then lo = mid + 1 else hi = mid end end return lo / 6 end) end
do  add('bubble', function(p, s) local t = {p.x, p.y, p.z, s.u} for i = 1, #t do for j = 1, #t - i do if t[j] > t[j + 1] then t[j], t[j + 1] = t[j + 1], t[j] end end end return t[2] end) end
do  add('newton', function(p) local x = 1.0 for i = 1, 20 do local f = x * x - math.abs(p.x) if math.abs(f) < 1e-6 then break end x = x - f / (2 * x) end return x end) end
do local function gcd(a, b) if b < 1 then return a end return gcd(b, a % b) end  add('gcd', function(p) return gcd(math.floor(math.abs(p.x)) % 16, 12) / 12 end) end
do  add('knight', function(p) local a = math.floor(p.x) & 1 local b = math.floor(p.z) & 1 return a ~ b end) end
do  add('hsv', function(p, s) local h = s.u * 6 local i = math.floor(h) local f = h - i local q, t = 1 - f, f if i < 1 then return {1, t, 0} elseif i < 2 then return {q, 1, 0} elseif i < 3 then return {0, 1, t} elseif i < 4 then return {0, q, 1} elseif i < 5 then return {t, 0, 1} end return {1, 0, q} end) end
do  add('hsv ==', function(p, s) local h = s.u * 6 local i = math.floor(h) if i == 0 then return {1, 0, 0} elseif i == 1 then return {0, 1, 0} end return {0, 0, 1} end) end
do  add('voronoi', function(p) local best = 9.0 local ix, iz = math.floor(p.x), math.floor(p.z) for i = -1, 1 do for j = -1, 1 do local cx, cz = ix + i, iz + j local ox, oz = gr.hash(cx, 0, cz), gr.hash(cx, 1, cz) local d = (cx + ox - p.x) ^ 2 + (cz + oz - p.z) ^ 2 best = math.min(best, d) end end return math.sqrt(best) end) end
do  add('voronoi if', function(p) local best = 9.0 local ix, iz = math.floor(p.x), math.floor(p.z) for i = -1, 1 do for j = -1, 1 do local d = (ix + i - p.x) ^ 2 + (iz + j - p.z) ^ 2 + gr.hash(ix + i, 0, iz + j) if d < best then best = d end end end return best end) end

assert(count >= 100, count)
