-- Functions as users write them, and the functions of the library, recorded with the bits of Lua (gr.fn compares them).
local colour, easing, noise = require 'colour', require 'easing', require 'noise'
local claims = require 'claims'

claims.claim('thirty functions as users write them are recorded', function()
    local function fbm(q, octaves)
        if octaves == 0 then return 0 end
        return gr.noise(q) + 0.5 * fbm(q * 2, octaves - 1)
    end
    local Stripe = {}
    Stripe.__index = Stripe
    function Stripe:at(p) return math.sin(p.x * self.k) > self.cut and self.on or self.off end
    local stripe = setmetatable({ k = 9, cut = 0.2, on = { 1, 0, 0 }, off = { 1, 1, 1 } }, Stripe)
    local users = {
        function(p) return 0.5 + 0.5 * math.sin(math.sqrt(p.x ^ 2 + p.z ^ 2) * 12) end,
        function(_, s)
            if s.u > 0.5 then return gr.vec(1, 0, 0) end
            if s.v > 0.5 then return gr.vec(0, 1, 0) end
            return { 0, 0, 1 }
        end,
        function(p)
            local t = {}
            for i = 1, 3 do t[i] = math.abs(p[i]) % 1 end
            return t
        end,
        function(p)
            local sum = 0
            for _, v in ipairs { 1, 2, 4 } do sum = sum + v * p.x end
            return sum
        end,
        function(p) return (p * 2 - 1):length() - 0.5 end,
        function(p)
            local x, y, z = p.x, p.y, p.z
            return x > y and (x > z and { 1, 0, 0 } or { 0, 0, 1 }) or (y > z and { 0, 1, 0 } or { 0, 0, 1 })
        end,
        function(_, s) return math.max(0, s.normal:dot(gr.vec(0, 1, 0))) end,
        function(_, s) return 1 - math.abs(s.normal:dot(s.view)) ^ 2 end,
        function(p)
            local n = 0
            for i = 1, 5 do n = n + math.abs(gr.noise(p.x * 2 ^ i, p.y * 2 ^ i, p.z * 2 ^ i)) / 2 ^ i end
            return { n, n * 0.5, 0 }
        end,
        function(p) return (math.tointeger(math.floor(p.x * 4)) * 7919 % 13) / 13 end,
        function(p)
            local h = math.floor(p.x) * 374761393 + math.floor(p.y) * 668265263
            h = (h ~ (h >> 13)) * 1274126177
            return ((h ~ (h >> 16)) & 0xffff) / 65535
        end,
        function(p)
            local x, y, n = 0, 0, 0
            for i = 1, 12 do
                x, y = x * x - y * y + p.x, 2 * x * y + p.y
                if x * x + y * y > 4 then n = i break end
            end
            return n / 12
        end,
        function(p) return (math.atan(p.z, p.x) / math.pi * 6) % 1 < 0.5 and 0.2 or 0.9 end,
        function(p) return fbm(p, 5) end,
        function(p) return gr.lookup({ { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } }, 1 + p.y % 3) end,
        function(_, s) return gr.mix({ 1, 1, 1 }, { 0.1, 0.3, 0.8 }, gr.smoothstep(0, 1, s.v)) end,
        function(p)
            local d = 1e9
            for i = 0, 3 do for j = 0, 3 do d = math.min(d, (p.x - i) ^ 2 + (p.z - j) ^ 2) end end
            return math.sqrt(d)
        end,
        function(p) return stripe:at(p) end,
        function(p)
            local good, value = pcall(function() return p.x * 2 end)
            return good and value or 0
        end,
        function(p) return (select(2, p.x, p.y, p.z)) end,
        function(p)
            local a, b, c = table.unpack { p.x, p.y, p.z }
            return a * b + c
        end,
        function(p) return math.min(math.max(p.y, 0), 1) end,
        function(p) if p.y ~= p.y then return 0 end return p.y end,
        function(p)
            local t = setmetatable({}, { __index = function(_, k) return k * p.x end })
            return t[3] + t[4]
        end,
        function(p) return p.x // 1 | 0 & 1 end,
        function(p)
            local co = coroutine.wrap(function() coroutine.yield(p.x * 3) end)
            return co()
        end,
        function(p)
            local a, b = p.x, p.y
            if a > b then a, b = b, a end
            return (b - a) / (1 + a * a)
        end,
        function(p)
            local i, sum = 0, 0
            repeat
                i = i + 1
                sum = sum + math.exp(-i * p.x * p.x)
            until i >= 6
            return sum
        end,
        function(p)
            local closest, id = math.huge, 0
            for i, c in ipairs { { 0, 0, 0 }, { 1, 1, 0 }, { 2, -1, 1 } } do
                local d = gr.length(p - gr.vec(c))
                if d < closest then closest, id = d, i end
            end
            return gr.vec(closest, id / 3, 0)
        end,
        function(p, s)
            local ground = p.y < 0.2 and { 0.1, 0.2, 0.5 } or p.y < 1 and { 0.2, 0.5, 0.1 } or { 1, 1, 1 }
            return gr.mix(ground, { 0.4, 0.35, 0.3 }, gr.smoothstep(0.6, 0.8, 1 - s.normal.y))
        end,
    }
    assert(#users == 30)
    for i, f in ipairs(users) do
        local good, why = pcall(gr.fn, f)
        assert(good, ('function %d: %s'):format(i, why))
    end
end)

claims.claim('every easing is recorded', function()
    local count = 0
    for name, f in pairs(easing) do
        if name ~= 'mix' and name ~= 'keys' then -- these take tables
            gr.fn(function(p) return f(p.x) end)
            count = count + 1
        end
    end
    assert(count > 20, count)
    gr.fn(function(p) return easing.mix(easing.in_out_cubic, { 0, 0, 0 }, { 4, 1, 0 }, p.x) end)
end)

claims.claim('colours and noise are recorded', function()
    gr.fn(function(p) return colour.hsv(p.x * 90, 0.6, 0.8) end)
    gr.fn(function(_, s) return colour.linear { s.u, s.v, 0.5 } end)
    gr.fn(function(_, s) return colour.srgb { s.u, s.v, 0.5 } end)
    gr.fn(function(_, s) return colour.luminance { s.u, s.v, 0.5 } end)
    gr.fn(function(_, s) return colour.mix({ 1, 0, 0 }, { 0, 0, 1 }, s.u) end)
    gr.fn(function(_, s) return colour.scale({ 1, 0.5, 0.25 }, s.u) end)
    gr.fn(function(_, s) return colour.blend({ 1, 0, 0 }, { 0, 0, 1 }, s.u) end)
    gr.fn(function(_, s) return colour.oklab(colour.to_oklab { s.u, s.v, 0.5 }) end)
    gr.fn(function(_, s) return colour.palette('viridis', s.u) end)
    gr.fn(function(p) return colour.cosine({ 0.5, 0.5, 0.5 }, { 0.5, 0.5, 0.5 }, { 1, 1, 1 }, { 0, 0.33, 0.67 }, p.x) end)
    gr.fn(function(p) return noise.sum(p.x, p.y, p.z, 5) + noise.noise(p.x, p.y, p.z) end)
end)
