-- text: solid letters, from a font file (gr.glyphs, by FreeType) or from the built-in letters of the library.
-- Idea: outlines stay curves as long as possible. text.node gives exact prisms, which can be operands of CSG; text.mesh
-- samples the curves and can bevel the edges (polygon.extrude).
-- Invariant: text is in the plane z = 0 and extruded towards +z; its first base line begins at the origin (or is
-- centred or ends there). Sizes: an em of a font file is `size` high; the library's capitals are 0.7 of it.
--
--   local text = require 'text'
--   scene:add_child(text.node('Guten Tag', {size = 1, depth = 0.2, material = brass, align = 'centre'}))
--   local mesh = {text.mesh('a & b', {font = 'fonts/Some.ttf', depth = 0.3, bevel = 0.03, steps = 3})}
--   scene:add_child(gr.vn_mesh(marble, table.unpack(mesh)))

local check = require 'check'
local font = require 'font'
local polygon = require 'polygon'

local M = {}

local LETTER <const> = 0.7 / 6 -- the ratio of an em to a unit of the library's strokes

--- A line of the library's letters in the form of gr.glyphs.
local function own_line(line, weight)
    local glyphs, x = { ascender = 0.85, descender = -0.3, line = 1.2 }, 0
    for _, code in utf8.codes(line) do
        local contours, width = font.outline(utf8.char(code), weight)
        local glyph = { code = code, contours = {}, missing = not contours and code ~= 32 and code ~= 160 }
        glyph.x = (x + weight / 2 + 0.25) * LETTER
        for c, pieces in ipairs(contours or {}) do
            local out = {}
            for k, p in ipairs(pieces) do
                local q = pieces[k % #pieces + 1]
                -- a parabola as a cubic
                for _, point in ipairs { { p[1], p[2] }, { p[1] + (p[3] - p[1]) * 2 / 3, p[2] + (p[4] - p[2]) * 2 / 3 },
                                         { q[1] + (p[3] - q[1]) * 2 / 3, q[2] + (p[4] - q[2]) * 2 / 3 } } do
                    out[#out + 1] = { point[1] * LETTER, point[2] * LETTER }
                end
            end
            glyph.contours[c] = out
        end
        local advance = contours and width + weight + 0.5 or 2.6
        glyph.advance = advance * LETTER
        glyphs[#glyphs + 1] = glyph
        x = x + advance
    end
    glyphs.width = x * LETTER
    return glyphs
end

--- Whether this build can read font files.
---@return boolean
function M.has_fonts()
    local ok, message = pcall(gr.glyphs, 'text.has_fonts', '')
    return ok or not tostring(message):find('made without FreeType', 1, true)
end

local known = 'font size align line weight spacing'

--- Letters at their positions.
---@param string string  lines are parted by \n
---@param options table?  font: a file, or none for the library's letters; size (1), align: 'left', 'centre' or 'right'
---  ('left'), line: line spacing relative to the font's (1), spacing: added between letters, in ems (0), weight:
---  thickness of the library's letters relative to the default (1)
---@return table letters  a list of { code, contours }: closed cubic outlines of points {x, y}, 3 for each piece, as gr.prism
---  takes them with spline 'bezier'; with width: of the longest line, low, high: y of the lowest and highest line's edge
function M.letters(string, options)
    local where = 'text.letters'
    check.text(where, 'string', string)
    options = check.options(where, options, known)
    local size = check.above(where, 'size', options.size, 0, 1)
    local align = check.word(where, 'align', options.align, 'left centre right', 'left')
    local distance = check.number(where, 'line', options.line, nil, nil, 1)
    local spacing = check.number(where, 'spacing', options.spacing, nil, nil, 0)
    local weight = check.number(where, 'weight', options.weight, 0.2, 2, 1) * 0.9
    if options.font ~= nil then check.text(where, 'font', options.font) end
    if not utf8.len(string) then check.fail(where, 'string must be UTF-8') end
    if not options.font then font.warn_of_missing(string) end
    local out, y, width = { low = 0, high = 0 }, 0, 0
    local count = 0
    for line in (string .. '\n'):gmatch '(.-)\n' do
        local glyphs = options.font and gr.glyphs(options.font, line) or own_line(line, weight)
        local total = (glyphs.width + spacing * math.max(0, #glyphs - 1)) * size
        local x0 = align == 'left' and 0 or align == 'centre' and -total / 2 or -total
        if count == 0 then out.high = glyphs.ascender * size end
        for k, glyph in ipairs(glyphs) do
            local letter = { code = glyph.code, contours = {} }
            for c, contour in ipairs(glyph.contours) do
                local moved = {}
                for i, p in ipairs(contour) do
                    moved[i] = { x0 + (glyph.x + spacing * (k - 1) + p[1]) * size, y + p[2] * size }
                end
                letter.contours[c] = moved
            end
            if #letter.contours > 0 then out[#out + 1] = letter end
        end
        out.low = y + glyphs.descender * size
        width, count = math.max(width, total), count + 1
        y = y - glyphs.line * size * distance
    end
    out.width = width
    return out
end

--- Samples cubic pieces so that every chord is within a tolerance of the curve.
---@param contour number[][]  3 points for each piece
---@param tolerance number
---@return number[][] outline
function M.points(contour, tolerance)
    local where = 'text.points'
    check.points(where, 'contour', contour, 2, 3)
    check.above(where, 'tolerance', tolerance, 0)
    local out, n = {}, #contour
    if n % 3 ~= 0 then check.fail(where, 'contour must have three points for each piece') end
    local function add(x, y)
        local last = out[#out]
        if not last or last[1] ~= x or last[2] ~= y then out[#out + 1] = { x, y } end
    end
    for k = 1, n, 3 do
        local a, b, c, d = contour[k], contour[k + 1], contour[k + 2], contour[(k + 2) % n + 1]
        -- the second derivative bounds the distance of the chord: |p''| / 8 pieces^2
        local bend = math.max(math.abs(a[1] - 2 * b[1] + c[1]) + math.abs(a[2] - 2 * b[2] + c[2]),
            math.abs(b[1] - 2 * c[1] + d[1]) + math.abs(b[2] - 2 * c[2] + d[2]))
        local pieces = math.max(1, math.min(64, math.ceil(math.sqrt(0.75 * bend / tolerance) - 1e-9)))
        for i = 0, pieces - 1 do
            local t = i / pieces
            local s = 1 - t
            add(a[1] * s ^ 3 + 3 * b[1] * s * s * t + 3 * c[1] * s * t * t + d[1] * t ^ 3,
                a[2] * s ^ 3 + 3 * b[2] * s * s * t + 3 * c[2] * s * t * t + d[2] * t ^ 3)
        end
    end
    local first, last = out[1], out[#out]
    if #out > 1 and first[1] == last[1] and first[2] == last[2] then out[#out] = nil end
    return out
end

local function split_options(where, options, more)
    options = check.options(where, options, known .. ' ' .. more)
    local set = {}
    for name in known:gmatch '%S+' do set[name] = options[name] end
    return options, set
end

--- The text as exact prisms, one for each letter: flat ends, curved sides, operands of CSG.
---@param string string
---@param options table  as for letters; depth (0.2 of the size), material
---@return gr.node
function M.node(string, options)
    local where = 'text.node'
    local set
    options, set = split_options(where, options, 'depth material')
    local depth = check.above(where, 'depth', options.depth, 0, 0.2 * (options.size or 1))
    -- a prism has its base in x and z with y up: rotated, it faces +z
    local node = gr.node 'text'
    node:rotate('x', 90)
    for _, letter in ipairs(M.letters(string, set)) do
        local outlines = {}
        for c, contour in ipairs(letter.contours) do
            outlines[c] = {}
            for k, p in ipairs(contour) do outlines[c][k] = { p[1], -p[2] } end
        end
        local fields = { name = utf8.char(letter.code), outline = table.remove(outlines, 1), holes = outlines, to = depth,
                         spline = 'bezier', material = options.material }
        node:add_child(gr.prism(fields))
    end
    return node
end

--- The text as one mesh; each letter is closed.
---@param string string
---@param options table  as for letters; depth (0.2 of the size), bevel: how far the edges are cut away (0), steps: pieces of
---  a round bevel (1: flat), back: whether the back edges are bevelled, too (false), tolerance: of curves (0.002 of the
---  size)
---@return number[][] verts
---@return number[][] normals
---@return integer[][] faces
---@return integer[][] face_normals
function M.mesh(string, options)
    local where = 'text.mesh'
    local set
    options, set = split_options(where, options, 'depth bevel steps back tolerance')
    local size = options.size or 1
    local depth = check.above(where, 'depth', options.depth, 0, 0.2 * size)
    local tolerance = check.above(where, 'tolerance', options.tolerance, 0, 0.002 * size)
    local meshes, list = require 'meshes', {}
    for _, letter in ipairs(M.letters(string, set)) do
        local outlines = {}
        for _, contour in ipairs(letter.contours) do
            local points = M.points(contour, tolerance)
            if #points >= 3 and polygon.area(points) ~= 0 then outlines[#outlines + 1] = points end
        end
        if #outlines > 0 then
            list[#list + 1] = { polygon.extrude(outlines, depth, { bevel = options.bevel, steps = options.steps, back = options.back }) }
        end
    end
    if #list == 0 then check.fail(where, 'string has no letter that can be seen') end
    local mesh = meshes.merge(list)
    return mesh[1], mesh[2], mesh[3], mesh[4]
end

return M
