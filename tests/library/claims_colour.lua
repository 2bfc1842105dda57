local colour, easing = require 'colour', require 'easing'
local claims = require 'claims'
local near = claims.near

local function same(a, b, tolerance, what)
    for k = 1, 3 do near(a[k], b[k], tolerance, what) end
end

claims.claim('hues are those of the wheel and come back', function()
    same(colour.hsv(0, 1, 1), { 1, 0, 0 }, 1e-12, 'red')
    same(colour.hsv(120, 1, 1), { 0, 1, 0 }, 1e-12, 'green')
    same(colour.hsv(240, 1, 0.5), { 0, 0, 0.5 }, 1e-12, 'blue')
    same(colour.hsv(60, 0.5, 1), { 1, 1, 0.5 }, 1e-12, 'pale yellow')
    for hue = 5, 355, 10 do
        local h, s, v = colour.to_hsv(colour.hsv(hue, 0.3, 0.7))
        near(h, hue, 1e-9, 'hue')
        near(s, 0.3, 1e-12, 'saturation')
        near(v, 0.7, 1e-12, 'value')
    end
end)

claims.claim('hexadecimal colours and the sRGB curve', function()
    same(colour.hex '#ff8000', { 1, 128 / 255, 0 }, 1e-12, 'hex')
    same(colour.hex 'f80', { 1, 136 / 255, 0 }, 1e-12, 'short')
    same(colour.linear { 0.5, 0.02, 1 }, { 0.21404114, 0.02 / 12.92, 1 }, 1e-7, 'linear')
    same(colour.srgb(colour.linear { 0.1, 0.5, 0.9 }), { 0.1, 0.5, 0.9 }, 1e-9, 'there and back')
end)

claims.claim('oklab has white at 1, 0, 0 and comes back', function()
    same(colour.to_oklab { 1, 1, 1 }, { 1, 0, 0 }, 1e-6, 'white')
    same(colour.oklab(colour.to_oklab { 0.2, 0.5, 0.7 }), { 0.2, 0.5, 0.7 }, 1e-6, 'there and back')
    same(colour.blend({ 1, 0, 0 }, { 0, 0, 1 }, 0), { 1, 0, 0 }, 1e-5, 'begin')
    same(colour.blend({ 1, 0, 0 }, { 0, 0, 1 }, 1), { 0, 0, 1 }, 1e-5, 'end')
end)

claims.claim('glowing bodies are red, then white near 6600 kelvin, then blue', function()
    local candle, day, sky = colour.blackbody(1900), colour.blackbody(6600), colour.blackbody(20000)
    assert(candle[1] == 1 and candle[2] < 0.6 and candle[3] < 0.1)
    for k = 1, 3 do assert(day[k] > 0.9) end
    assert(sky[3] == 1 and sky[1] < 0.6)
    for kelvin = 1000, 39000, 1000 do
        local a, b = colour.blackbody(kelvin), colour.blackbody(kelvin + 1000)
        assert(b[3] / b[1] >= a[3] / a[1])
    end
end)

claims.claim('palettes begin and end with their colours and are joined', function()
    for _, name in ipairs { 'viridis', 'magma', 'safe', 'land', 'earth', 'sea', 'sunset', 'pastel', 'toy' } do
        local list = colour.colours(name)
        same(colour.palette(name, 0), list[1], 1e-12, name)
        same(colour.palette(name, 1), list[#list], 1e-12, name)
        for t = 0, 1, 0.01 do
            local a, b = colour.palette(name, t), colour.palette(name, t + 0.001)
            for k = 1, 3 do assert(math.abs(a[k] - b[k]) < 0.02) end
        end
    end
    same(colour.palette({ { 0, 0, 0 }, { 1, 1, 1 } }, 0.25), { 0.25, 0.25, 0.25 }, 1e-12, 'own')
    -- the brightness of viridis increases monotonically
    local before = -1
    for t = 0, 1, 0.05 do
        local y = colour.luminance(colour.linear(colour.palette('viridis', t)))
        assert(y > before)
        before = y
    end
    assert(#colour.wheel(12) == 12)
end)

claims.claim('every easing begins at 0, ends at 1 and meets in the middle', function()
    for _, name in ipairs { 'sine', 'quad', 'cubic', 'quart', 'expo', 'circ', 'back', 'elastic', 'bounce' } do
        for _, way in ipairs { 'in_', 'out_', 'in_out_' } do
            local f = easing[way .. name]
            near(f(0), 0, 1e-12, name)
            near(f(1), 1, 1e-12, name)
            near(f(-3), 0, 1e-12, name)
            near(f(7), 1, 1e-12, name)
        end
        near(easing['in_out_' .. name](0.5), 0.5, 1e-9, name)
        for t = 0, 1, 0.1 do near(easing['out_' .. name](t), 1 - easing['in_' .. name](1 - t), 1e-12, name) end
    end
    near(easing.smooth(0.5), 0.5, 1e-12, 'smooth')
    near(easing.in_cubic(0.5), 0.125, 1e-12, 'cubic')
end)

claims.claim('keys are met at their times', function()
    local keys = { { 0, { 0, 0 } }, { 2, { 4, 1 } }, { 3, { 4, 2 } } }
    for _, key in ipairs(keys) do
        local v = easing.keys(keys, key[1])
        near(v[1], key[2][1], 1e-12, 'key')
        near(v[2], key[2][2], 1e-12, 'key')
    end
    near(easing.keys(keys, 1, easing.linear)[1], 2, 1e-12, 'between')
    near(easing.keys({ { 0, 1 }, { 1, 3 } }, 9), 3, 1e-12, 'after')
end)

claims.claim('wrong arguments are named', function()
    claims.fails("colour.palette: there is no palette 'blue'; there are earth, land, magma", colour.palette, 'blue', 0)
    claims.fails('colour.hex: text must be three or six hexadecimal digits', colour.hex, '#12')
    claims.fails('colour.mix: b[3] must be a number, not nothing', colour.mix, { 0, 0, 0 }, { 1, 1 }, 0)
    claims.fails('easing.in_sine: t must be a number, not nothing', easing.in_sine)
    claims.fails('easing.keys: the time of keys[2] must be later', easing.keys, { { 0, 1 }, { 0, 2 } }, 1)
end)

claims.claim('errors stand at the line of the script that called', function()
    local ok, message = pcall(function()
        colour.hex(7) -- this line
    end)
    assert(not ok and message:find('claims_colour.lua:105: colour.hex: text must be a string, not 7', 1, true), message)
    -- through the library into itself
    ok, message = pcall(function()
        colour.blend({ 0, 0, 0 }, { 1, 1 }, 0)
    end)
    assert(not ok and message:find('claims_colour.lua:110:', 1, true), message)
end)
