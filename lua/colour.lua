-- colour: colours by hue, by name, by temperature; mixing; palettes.
-- Colours are tuples {r, g, b} as for materials and lights. A picture file has them unchanged unless it is written
-- with --srgb; then use linear ones: colour.linear converts the sRGB values of a colour picker.
-- Sources: A. Smith, "Color Gamut Transform Pairs", SIGGRAPH 1978 (hsv); B. Ottosson, "A perceptual color space for image
-- processing", 2020 (oklab); IEC 61966-2-1 (the sRGB curve); Planck's law by the fits of C. Wyman et al., JCGT 2(2), 2013,
-- to the CIE functions (blackbody); the palettes viridis and magma of S. van der Walt and N. Smith (matplotlib, CC0);
-- M. Okabe and K. Ito, "Color Universal Design", 2008; I. Quilez, "Palettes" (cosine).
--
--   local colour = require 'colour'
--   local red = gr.material(colour.hsv(8, 0.8, 0.7), {0.2, 0.2, 0.2}, 30)
--   local lamp = gr.light({0, 4, 0}, colour.blackbody(2700), {1, 0, 0})
--   local c = colour.palette('viridis', height / top)

local check = require 'check'

local M = {}

local function clamp(x) return x < 0 and 0 or x > 1 and 1 or x end

--- '#4080ff', '4080ff' or '#48f'.
---@param text string
---@return number[]
function M.hex(text)
    check.text('colour.hex', 'text', text)
    local digits = text:match '^#?(%x+)$'
    if digits and #digits == 3 then digits = digits:gsub('%x', '%0%0') end
    if not digits or #digits ~= 6 then
        check.fail('colour.hex', ("text must be three or six hexadecimal digits, not '%s'"):format(text:sub(1, 40)))
    end
    local out = {}
    for k = 1, 3 do out[k] = tonumber(digits:sub(2 * k - 1, 2 * k), 16) / 255 end
    return out
end

--- Hue in degrees (0 red, 120 green, 240 blue), saturation, value.
---@return number[]
function M.hsv(hue, saturation, value)
    check.number('colour.hsv', 'hue', hue)
    check.number('colour.hsv', 'saturation', saturation, 0, 1)
    check.number('colour.hsv', 'value', value, 0)
    local out = {}
    for k = 0, 2 do
        local h = (hue / 60 + (k == 0 and 5 or k == 1 and 3 or 1)) % 6
        out[k + 1] = value - value * saturation * math.max(0, math.min(h, 4 - h, 1))
    end
    return out
end

--- Hue, saturation and value of a colour.
function M.to_hsv(colour)
    check.tuple('colour.to_hsv', 'colour', colour, 3)
    local r, g, b = colour[1], colour[2], colour[3]
    local high, low = math.max(r, g, b), math.min(r, g, b)
    local span, hue = high - low, 0
    if span > 0 then
        if high == r then hue = (g - b) / span % 6 elseif high == g then hue = (b - r) / span + 2 else hue = (r - g) / span + 4 end
    end
    return 60 * hue, high > 0 and span / high or 0, high
end

--- Converts sRGB, as in a colour picker, to linear.
function M.linear(colour)
    check.tuple('colour.linear', 'colour', colour, 3)
    local out = {}
    for k = 1, 3 do out[k] = colour[k] <= 0.04045 and colour[k] / 12.92 or ((colour[k] + 0.055) / 1.055) ^ 2.4 end
    return out
end

--- Converts linear to sRGB, as in a colour picker.
function M.srgb(colour)
    check.tuple('colour.srgb', 'colour', colour, 3)
    local out = {}
    for k = 1, 3 do out[k] = colour[k] <= 0.0031308 and colour[k] * 12.92 or 1.055 * colour[k] ^ (1 / 2.4) - 0.055 end
    return out
end

--- Brightness of a linear colour (Rec. 709).
function M.luminance(colour)
    check.tuple('colour.luminance', 'colour', colour, 3)
    return 0.2126 * colour[1] + 0.7152 * colour[2] + 0.0722 * colour[3]
end

--- Interpolates linearly from a to b.
---@return number[]
function M.mix(a, b, share)
    check.tuple('colour.mix', 'a', a, 3)
    check.tuple('colour.mix', 'b', b, 3)
    check.number('colour.mix', 'share', share)
    return { a[1] + (b[1] - a[1]) * share, a[2] + (b[2] - a[2]) * share, a[3] + (b[3] - a[3]) * share }
end

--- Brighter (above 1) or darker.
function M.scale(colour, factor)
    check.tuple('colour.scale', 'colour', colour, 3)
    check.number('colour.scale', 'factor', factor, 0)
    return { colour[1] * factor, colour[2] * factor, colour[3] * factor }
end

--- Oklab lightness, a and b of a linear colour.
function M.to_oklab(colour)
    check.tuple('colour.to_oklab', 'colour', colour, 3)
    local r, g, b = colour[1], colour[2], colour[3]
    local function root(x) return x < 0 and -(-x) ^ (1 / 3) or x ^ (1 / 3) end
    local l = root(0.4122214708 * r + 0.5363325363 * g + 0.0514459929 * b)
    local m = root(0.2119034982 * r + 0.6806995451 * g + 0.1073969566 * b)
    local s = root(0.0883024619 * r + 0.2817188376 * g + 0.6299787005 * b)
    return { 0.2104542553 * l + 0.7936177850 * m - 0.0040720468 * s, 1.9779984951 * l - 2.4285922050 * m + 0.4505937099 * s,
             0.0259040371 * l + 0.7827717662 * m - 0.8086757660 * s }
end

--- The linear colour of an Oklab triple.
function M.oklab(lab)
    check.tuple('colour.oklab', 'lab', lab, 3)
    local l = (lab[1] + 0.3963377774 * lab[2] + 0.2158037573 * lab[3]) ^ 3
    local m = (lab[1] - 0.1055613458 * lab[2] - 0.0638541728 * lab[3]) ^ 3
    local s = (lab[1] - 0.0894841775 * lab[2] - 1.2914855480 * lab[3]) ^ 3
    return { 4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s, -1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s,
             -0.0041960863 * l - 0.7034186147 * m + 1.7076147010 * s }
end

--- Interpolates between two sRGB colours perceptually (in Oklab).
function M.blend(a, b, share)
    local p, q = M.to_oklab(M.linear(a)), M.to_oklab(M.linear(b))
    local out = M.srgb(M.oklab(M.mix(p, q, check.number('colour.blend', 'share', share))))
    return { clamp(out[1]), clamp(out[2]), clamp(out[3]) }
end

--- The colour of a black body, its largest component 1: 1900 a candle, 2700 a lamp, 5800 the sun.
---@param kelvin number  800 to 40000
---@return number[]  linear
function M.blackbody(kelvin)
    check.number('colour.blackbody', 'kelvin', kelvin, 800, 40000)
    local x, y, z = 0, 0, 0
    local function bell(wave, middle, left, right)
        local t = (wave - middle) * (wave < middle and left or right)
        return math.exp(-t * t / 2)
    end
    for wave = 380, 780, 5 do
        local power = (wave / 560) ^ -5 / (math.exp(1.438776877e7 / (wave * kelvin)) - 1)
        x = x + power * (1.056 * bell(wave, 599.8, 0.0264, 0.0323) + 0.362 * bell(wave, 442.0, 0.0624, 0.0374) -
            0.065 * bell(wave, 501.1, 0.0490, 0.0382))
        y = y + power * (0.821 * bell(wave, 568.8, 0.0213, 0.0247) + 0.286 * bell(wave, 530.9, 0.0613, 0.0322))
        z = z + power * (1.217 * bell(wave, 437.0, 0.0845, 0.0278) + 0.681 * bell(wave, 459.0, 0.0385, 0.0725))
    end
    local r, g, b = 3.2404542 * x - 1.5371385 * y - 0.4985314 * z, -0.9692660 * x + 1.8760108 * y + 0.0415560 * z,
        0.0556434 * x - 0.2040259 * y + 1.0572252 * z
    local most = math.max(r, g, b)
    return { clamp(r / most), clamp(g / most), clamp(b / most) }
end

local palettes = {
    viridis = '440154 482878 3e4989 31688e 26828e 1f9e89 35b779 6ece58 b5de2b fde725',
    magma = '000004 180f3d 440f76 721f81 9e2f7f cd4071 f1605d fd9668 feca8d fcfdbf',
    safe = 'e69f00 56b4e9 009e73 f0e442 0072b2 d55e00 cc79a7',
    land = '2f5d3a 5b7d3c 97994f b59f6c 8d7763 7d7672 a6a5a6 f2f4f7',
    earth = '3b2a1e 6b4a2f 96693c c08f55 dcb983 ede0c4',
    sea = '0b1e33 113a5c 1b5f86 2f8bab 68b8c9 bfe3e0',
    sunset = '20243f 4c3a63 8c4a6c cf6062 f28f5b fbc977',
    pastel = 'f4b6a6 f6d8a0 cfe3a8 a5d8c2 a6c8e4 c6b6e2',
    toy = 'c8382c e6862a f0c93a 4f9d4a 2f7fb5 7a4f9c',
}
local known = {}

local function colours_of(where, name)
    if type(name) == 'table' then return check.points(where, 'name', name, 3, 1) end
    check.text(where, 'name', name)
    if not palettes[name] then
        local names = {}
        for word in pairs(palettes) do names[#names + 1] = word end
        table.sort(names)
        check.fail(where, ("there is no palette '%s'; there are %s"):format(name:sub(1, 40), table.concat(names, ', ')))
    end
    if not known[name] then
        local list = {}
        for word in palettes[name]:gmatch '%S+' do list[#list + 1] = M.hex(word) end
        known[name] = list
    end
    return known[name]
end

--- The colours of a palette, as a list. Palettes: viridis, magma, safe (for colour-blind viewers), land, earth, sea,
--- sunset, pastel, toy.
---@param name string
---@return number[][]
function M.colours(name)
    local out = {}
    for k, c in ipairs(colours_of('colour.colours', name)) do out[k] = { c[1], c[2], c[3] } end
    return out
end

--- A colour along a palette.
---@param name string|number[][]  its name, or a list of colours
---@param t number  0 its first colour, 1 its last; clamped
---@return number[]
function M.palette(name, t)
    local list = colours_of('colour.palette', name)
    t = clamp(check.number('colour.palette', 't', t)) * (#list - 1)
    local k = math.min(math.floor(t), #list - 2)
    if #list < 2 then return { list[1][1], list[1][2], list[1][3] } end
    if gr.is_recorded(k) then return M.mix(gr.lookup(list, k + 1), gr.lookup(list, k + 2), t - k) end
    return M.mix(list[k + 1], list[k + 2], t - k)
end

--- A palette by cosines: a + b cos(2 pi (c t + d)) for each component.
function M.cosine(a, b, c, d, t)
    for k, v in ipairs { a, b, c, d } do check.tuple('colour.cosine', ('abcd'):sub(k, k), v, 3) end
    check.number('colour.cosine', 't', t)
    local out = {}
    for k = 1, 3 do out[k] = clamp(a[k] + b[k] * math.cos(2 * math.pi * (c[k] * t + d[k]))) end
    return out
end

--- n colours of equal brightness and saturation with well separated hues
--- (steps of the golden angle).
---@param count integer
---@param saturation number?  default 0.6
---@param value number?  default 0.8
---@param first number?  hue of the first, default 10
function M.wheel(count, saturation, value, first)
    check.whole('colour.wheel', 'count', count, 1, 100000)
    local out = {}
    for k = 0, count - 1 do out[k + 1] = M.hsv((first or 10) + k * 137.50776405, saturation or 0.6, value or 0.8) end
    return out
end

return M
