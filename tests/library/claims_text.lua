local text, polygon, meshes, font = require 'text', require 'polygon', require 'meshes', require 'font'
local claims = require 'claims'
local near = claims.near
local brass = gr.material({ .5, .5, .5 }, { 0, 0, 0 }, 1)
local file = '../../data/fonts/gray-round.ttf'

local function area(letters, tolerance)
    local sum = 0
    for _, letter in ipairs(letters) do
        local outlines = {}
        for c, contour in ipairs(letter.contours) do outlines[c] = text.points(contour, tolerance) end
        for _, body in ipairs(polygon.bodies(outlines)) do
            sum = sum + polygon.area(body[1])
            for _, hole in ipairs(body.holes) do sum = sum + polygon.area(hole) end
        end
    end
    return sum
end

claims.claim('letters are as thick as the pen', function()
    local pen = 0.9 * 0.7 / 6
    near(area(text.letters 'I', 1e-5), 0.7 * pen + math.pi * pen ^ 2 / 4, 1e-4, 'I')
    -- twice the weight
    near(area(text.letters('I', { weight = 2 }), 1e-5), 1.4 * pen + math.pi * pen ^ 2, 3e-4, 'bold I')
    near(area(text.letters('I', { size = 10 }), 1e-4), 100 * (0.7 * pen + math.pi * pen ^ 2 / 4), 1e-2, 'large I')
end)

claims.claim('letters with holes have them', function()
    local holes = { A = 1, B = 2, O = 1, g = 1, ['8'] = 2, i = 0, L = 0, e = 1 }
    for letter, count in pairs(holes) do
        local outlines, bodies = {}, 0
        for c, contour in ipairs(text.letters(letter)[1].contours) do outlines[c] = text.points(contour, 1e-3) end
        for _, body in ipairs(polygon.bodies(outlines)) do bodies = bodies + #body.holes end
        assert(bodies == count, ('%s has %d holes'):format(letter, bodies))
    end
    assert(#text.letters('i')[1].contours == 2)
end)

claims.claim('every fourth letter of the library is a closed solid', function()
    for k, letter in ipairs(font.letters()) do
        if k % 4 ~= 1 then goto continue end
        local verts, normals, faces, face_normals = text.mesh(letter, { depth = 0.1, tolerance = 0.01 })
        assert(meshes.is_closed(faces) and #faces == #face_normals, letter)
        near(meshes.volume(verts, faces), 0.1 * area(text.letters(letter), 0.01), 1e-9, letter)
        assert(#normals > 0)
        ::continue::
    end
end)

claims.claim('every letter of Latin-1 and Windows-1252 that has ink has a shape', function()
    local names = '€‚ƒ„…†‡ˆ‰Š‹ŒŽ‘’“”•–—˜™š›œžŸ'
    for code = 33, 255 do
        if code < 127 or code > 160 then names = names .. utf8.char(code) end
    end
    for letter in names:gmatch(utf8.charpattern) do
        local strokes, width = font.strokes(letter)
        assert(#strokes > 0 and width >= 0, letter)
    end
    -- an accent stands in the middle of its letter, above it; a capital's is higher
    local function middle(letter, above)
        local low, high = math.huge, -math.huge
        for _, points in ipairs(font.strokes(letter)) do
            for _, p in ipairs(points) do
                if p[2] > above then low, high = math.min(low, p[1]), math.max(high, p[1]) end
            end
        end
        return (low + high) / 2
    end
    for letter, above in pairs { ['Ä'] = 6.5, ['Ô'] = 6.5, ['ü'] = 4.5, ['î'] = 4.5, ['ñ'] = 4.5 } do
        near(middle(letter, above), select(2, font.strokes(letter)) / 2, 1e-9, letter)
    end
end)

claims.claim('lines are set below each other and aligned', function()
    local left, right = text.letters('abc\nde'), text.letters('abc\nde', { align = 'right' })
    local middle = text.letters('abc\nde', { align = 'centre' })
    near(left.width, right.width, 1e-12, 'width')
    local function x_of(letters, k) return letters[k].contours[1][1][1] end
    near(x_of(left, 1) - x_of(right, 1), left.width, 1e-12, 'first line')
    near(x_of(left, 1) - x_of(middle, 1), left.width / 2, 1e-12, 'first line in the middle')
    assert(x_of(left, 4) - x_of(right, 4) < left.width - 0.1)
    assert(left.low < -1 and left.high > 0.7)
    near(text.letters('aa', { spacing = 0.5 }).width - text.letters('aa').width, 0.5, 1e-12, 'spacing')
end)

claims.claim('curves are measured out within the tolerance', function()
    -- a circle of four cubic pieces, with an error of 3 in 10,000
    local k = 0.5522847498
    local circle = { { 1, 0 }, { 1, k }, { k, 1 }, { 0, 1 }, { -k, 1 }, { -1, k }, { -1, 0 }, { -1, -k }, { -k, -1 }, { 0, -1 }, { k, -1 }, { 1, -k } }
    for _, tolerance in ipairs { 0.1, 0.01, 0.001 } do
        local points = text.points(circle, tolerance)
        for i, p in ipairs(points) do
            local q = points[i % #points + 1]
            assert(1.0003 - math.sqrt((p[1] + q[1]) ^ 2 + (p[2] + q[2]) ^ 2) / 2 < tolerance + 0.0004)
        end
    end
end)

claims.claim('text is an operand of csg, as prisms and as a mesh', function()
    local scene = gr.node 'scene'
    local word = text.node('B', { depth = 0.3, material = brass })
    scene:add_child(word)
    local verts, normals, faces, face_normals = text.mesh('B', { bevel = 0.02, steps = 2, back = true })
    scene:add_child(gr.difference('cut', gr.nh_box(brass, { 0, 0, 0 }, 1), gr.vn_mesh(brass, verts, normals, faces, face_normals)))
    local low, high = word:bounds()
    near(low[3], 0, 1e-9, 'back')
    near(high[3], 0.3, 1e-9, 'front')
    near(high[2], 0.7 + 0.45 * 0.7 / 6, 2e-3, 'height')
    claims.build(scene)
end)

claims.claim('wrong arguments are named', function()
    claims.fails("text.letters: align must be 'left' or 'centre' or 'right', not 'middle'", text.letters, 'a', { align = 'middle' })
    claims.fails('text.mesh: there is no option hight; the options are font', text.mesh, 'a', { hight = 1 })
    claims.fails('text.mesh: string has no letter that can be seen', text.mesh, ' ')
    claims.fails('text.letters: string must be UTF-8', text.letters, '\xff')
end)

-- Tests that need FreeType; without it there is one line with a message.
if text.has_fonts() then
    claims.claim('a font file gives the same letters as the library, which drew it', function()
        local own, read = text.letters('Hamburg'), text.letters('Hamburg', { font = file })
        near(own.width, read.width, 0.004, 'width')
        near(area(own, 1e-4), area(read, 1e-4), 0.004, 'area')
        assert(#own == #read)
    end)
    claims.claim('kerning brings A and V together', function()
        local apart = text.letters('A', { font = file }).width + text.letters('V', { font = file }).width
        near(apart - text.letters('AV', { font = file }).width, 0.08, 1e-9, 'kerning')
    end)
    claims.claim('letters of a file are solids, too', function()
        local verts, _, faces = text.mesh('&8Qg', { font = file, bevel = 0.01 })
        assert(meshes.is_closed(faces) and meshes.volume(verts, faces) > 0)
        claims.build(text.node('Quick', { font = file, material = brass }))
    end)
    claims.claim('files that are no fonts are one line', function()
        claims.fails('claims_text.lua: not a font that can be read: ', gr.glyphs, 'claims_text.lua', 'a')
        claims.fails("gr.glyphs: cannot find 'no.ttf'", text.mesh, 'a', { font = 'no.ttf' })
    end)
else
    claims.claim('without FreeType the error says so', function()
        claims.fails('this build cannot read fonts (it was made without FreeType)', text.mesh, 'a', { font = file })
    end)
end
