-- Writes gray-round.ttf, the letters of lua/font.lua as a TrueType font, for the demos and the tests of gr.glyphs.
-- Run from the repository's root: ./gray --allow-write data/fonts data/fonts/make_font.lua
-- Source: Apple, "TrueType Reference Manual", chapter 6 (the tables).
-- Author: gray project

local font = require 'font'

local EM <const>, WEIGHT <const> = 1000, 0.9
local unit = EM * 0.7 / 6
local function round(x) return math.floor(x + 0.5) end

-- Each glyph: contours as points { x, y, on the curve }, and its advance.
local glyphs = { { code = 0, contours = { { { 50, 0, true }, { 50, 700, true }, { 450, 700, true }, { 450, 0, true } },
                                          { { 100, 50, true }, { 400, 50, true }, { 400, 650, true }, { 100, 650, true } } }, advance = 500 },
                 { code = 32, contours = {}, advance = round(2.6 * unit) }, { code = 160, contours = {}, advance = round(2.6 * unit) } }
for _, letter in ipairs(font.letters()) do
    local contours, width = font.outline(letter, WEIGHT)
    local left, made = WEIGHT / 2 + 0.25, {}
    for c, pieces in ipairs(contours) do
        local points = {}
        for k = #pieces, 1, -1 do -- TrueType has the inside on the right
            local p, q = pieces[k], pieces[k % #pieces + 1]
            points[#points + 1] = { round((q[1] + left) * unit), round(q[2] * unit), true }
            -- a piece whose control point is near the middle of its chord is straight
            local mx, my = (p[1] + q[1]) / 2 - p[3], (p[2] + q[2]) / 2 - p[4]
            if mx * mx + my * my > 1e-6 then points[#points + 1] = { round((p[3] + left) * unit), round(p[4] * unit), false } end
        end
        made[c] = points
    end
    glyphs[#glyphs + 1] = { code = utf8.codepoint(letter), contours = made, advance = round((width + WEIGHT + 0.5) * unit) }
end
table.sort(glyphs, function(a, b) return a.code < b.code end)

local number = {}
for k, glyph in ipairs(glyphs) do number[glyph.code] = k - 1 end

local function pack(format, ...) return string.pack('>' .. format, ...) end
local function padded(text) return text .. ('\0'):rep(-#text % 4) end

local glyf, loca, hmtx, at = {}, { pack('I4', 0) }, {}, 0
local low_x, low_y, high_x, high_y, most_points, most_contours, widest = 0, 0, 0, 0, 0, 0, 0
for k, glyph in ipairs(glyphs) do
    local data, x0, y0, x1, y1 = '', 32767, 32767, -32768, -32768
    if #glyph.contours > 0 then
        local ends, flags, xs, ys, count, last_x, last_y = {}, {}, {}, {}, 0, 0, 0
        for _, points in ipairs(glyph.contours) do
            for _, p in ipairs(points) do
                flags[#flags + 1] = pack('B', p[3] and 1 or 0)
                xs[#xs + 1], ys[#ys + 1] = pack('i2', p[1] - last_x), pack('i2', p[2] - last_y)
                last_x, last_y, count = p[1], p[2], count + 1
                x0, y0, x1, y1 = math.min(x0, p[1]), math.min(y0, p[2]), math.max(x1, p[1]), math.max(y1, p[2])
            end
            ends[#ends + 1] = pack('I2', count - 1)
        end
        data = padded(pack('i2i2i2i2i2', #glyph.contours, x0, y0, x1, y1) .. table.concat(ends) .. pack('I2', 0) ..
            table.concat(flags) .. table.concat(xs) .. table.concat(ys))
        low_x, low_y, high_x, high_y = math.min(low_x, x0), math.min(low_y, y0), math.max(high_x, x1), math.max(high_y, y1)
        most_points, most_contours = math.max(most_points, count), math.max(most_contours, #glyph.contours)
    else
        x0 = 0
    end
    glyf[k], at = data, at + #data
    loca[k + 1], hmtx[k] = pack('I4', at), pack('I2i2', glyph.advance, x0)
    widest = math.max(widest, glyph.advance)
end

-- runs of consecutive codes
local runs = {}
for k = 2, #glyphs do
    local code, run = glyphs[k].code, runs[#runs]
    if run and code == run[2] + 1 then run[2] = code else runs[#runs + 1] = { code, code, k - 1 } end
end
runs[#runs + 1] = { 0xffff, 0xffff, 0 }
local parts = { {}, {}, {}, {} }
for k, run in ipairs(runs) do
    parts[1][k], parts[2][k] = pack('I2', run[2]), pack('I2', run[1])
    parts[3][k], parts[4][k] = pack('I2', (run[1] == 0xffff and 1 or run[3] - run[1]) & 0xffff), pack('I2', 0)
end
local power = 1
while power * 2 <= #runs do power = power * 2 end
local segments = pack('I2I2I2I2', 2 * #runs, 2 * power, math.tointeger(math.log(power, 2) // 1), 2 * (#runs - power)) ..
    table.concat(parts[1]) .. pack('I2', 0) .. table.concat(parts[2]) .. table.concat(parts[3]) .. table.concat(parts[4])
local cmap = pack('I2I2I2I2I4', 0, 1, 3, 1, 12) .. pack('I2I2I2', 4, 6 + #segments, 0) .. segments

-- a few pairs that need kerning
local pairs_of = {}
for pair, move in ('AT-90 TA-90 AV-80 VA-80 AW-60 WA-60 AY-90 YA-90 LT-90 LV-80 LY-90 PA-70 FA-60 To-80 Ta-80 Te-80 Yo-70 Va-50 Vo-50 ry20'):gmatch '(%a%a)(%-?%d+)' do
    pairs_of[#pairs_of + 1] = { number[pair:byte(1)], number[pair:byte(2)], tonumber(move) }
end
table.sort(pairs_of, function(a, b) return a[1] < b[1] or (a[1] == b[1] and a[2] < b[2]) end)
local kern = {}
for k, pair in ipairs(pairs_of) do kern[k] = pack('I2I2i2', pair[1], pair[2], math.tointeger(pair[3])) end
power = 1
while power * 2 <= #kern do power = power * 2 end
kern = pack('I2I2I2I2I2', 0, 1, 0, 14 + 6 * #kern, 1) ..
    pack('I2I2I2I2', #kern, 6 * power, math.tointeger(math.log(power, 2) // 1), 6 * (#kern - power)) .. table.concat(kern)

local names, text = {}, {}
for k, item in ipairs { { 0, 'gray project, MIT licence' }, { 1, 'Gray Round' }, { 2, 'Regular' }, { 3, 'Gray Round 1' }, { 4, 'Gray Round' }, { 6, 'GrayRound' } } do
    local wide = item[2]:gsub('.', '\0%0')
    names[k] = pack('I2I2I2I2I2I2', 3, 1, 0x409, item[1], #wide, #table.concat(text))
    text[k] = wide
end

local ascender, descender = 850, -300
local tables = {
    ['OS/2'] = pack('I2i2I2I2I2', 3, 500, 400, 5, 0) .. pack('i2i2i2i2i2i2i2i2i2i2i2', 650, 600, 0, 75, 650, 600, 0, 350, 50, 250, 0) ..
        ('\0'):rep(10) .. pack('I4I4I4I4', 3, 0, 0, 0) .. 'GRAY' .. pack('I2I2I2', 0x40, 32, glyphs[#glyphs].code) ..
        pack('i2i2i2I2I2', ascender, descender, 50, ascender, -descender) .. pack('I4I4', 1, 0) .. pack('i2i2I2I2I2', 467, 700, 0, 32, 1),
    cmap = cmap,
    glyf = table.concat(glyf),
    head = pack('I4I4I4I4I2I2i8i8i2i2i2i2I2I2i2i2i2', 0x10000, 0x10000, 0, 0x5f0f3cf5, 0xb, EM, 3600000000, 3600000000, low_x, low_y, high_x,
        high_y, 0, 8, 2, 1, 0),
    hhea = pack('I4i2i2i2I2i2i2i2i2i2i2i8i2I2', 0x10000, ascender, descender, 50, widest, 0, 0, high_x, 1, 0, 0, 0, 0, #glyphs),
    hmtx = table.concat(hmtx),
    kern = kern,
    loca = table.concat(loca),
    maxp = pack('I4I2I2I2I2I2I2I2I2I2I2I2I2I2I2', 0x10000, #glyphs, most_points, most_contours, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0),
    name = pack('I2I2I2', 0, #names, 6 + 12 * #names) .. table.concat(names) .. table.concat(text),
    post = pack('I4i4i2i2I4I4I4I4I4', 0x30000, 0, -100, 50, 0, 0, 0, 0, 0),
}
local function checksum(data)
    local sum = 0
    for k = 1, #data, 4 do sum = sum + string.unpack('>I4', data, k) & 0xffffffff end
    return sum & 0xffffffff
end
local tags = {}
for tag in pairs(tables) do tags[#tags + 1] = tag end
table.sort(tags)
local function file()
    local directory, body = { pack('I4I2I2I2I2', 0x10000, #tags, 128, 3, 16 * #tags - 128) }, {}
    local offset = 12 + 16 * #tags
    for k, tag in ipairs(tags) do
        local data = tables[tag]
        directory[k + 1] = tag .. pack('I4I4I4', checksum(padded(data)), offset, #data)
        body[k], offset = padded(data), offset + #padded(data)
    end
    return table.concat(directory) .. table.concat(body)
end
local adjustment = 0xb1b0afba - checksum(file()) & 0xffffffff
tables.head = tables.head:sub(1, 8) .. pack('I4', adjustment) .. tables.head:sub(13)

local out = assert(io.open('data/fonts/gray-round.ttf', 'wb'))
out:write(file())
out:close()
print(('%d glyphs, %d bytes'):format(#glyphs, #file()))
