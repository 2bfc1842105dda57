-- Writes small files of every kind that gray reads, each a square from {0, 0} to {1, 1}, and reads them: the number of
-- their triangles and their colours are checked here. Each warning that is due is printed: the file that it names, a tab,
-- and words of it.
local KD, RED, GREEN, BLUE, GREY = {.25, .5, .75}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {.4, .4, .4}
local pack, cases, byte = string.pack, {}, string.char

local function write(name, bytes)
    local file = assert(io.open(name, 'wb'))
    file:write(bytes)
    file:close()
end

-- warning: words of it, after the name of another file and a colon if it names that one. right: a colour, or those of the lower left, lower right, upper left and upper right quarter. Without one the file has
-- no colour of its own, and gets one.
local function case(name, bytes, right, warning, triangles)
    write(name, bytes)
    cases[#cases + 1] = {name = name, right = right, warning = warning, triangles = triangles or 2}
end

local function bytes_of(format, numbers)
    local out = {}
    for k, x in ipairs(numbers) do out[k] = pack(format, x) end
    return table.concat(out)
end

-- Text formats, with every end of lines.
local ends = {lf = '\n', crlf = '\r\n', cr = '\r'}
local function text(name, extension, lines, right, warning, triangles)
    for word, line_end in pairs(ends) do
        case(name .. '-' .. word .. extension, (lines:gsub('\n', line_end)), right, warning, triangles)
    end
    case(name .. '-mark' .. extension, '\xef\xbb\xbf' .. lines, right, warning, triangles)
end

-- OBJ and MTL.
local V = 'v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n'
local T = 'vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n'
local N = 'vn 0 0 1\n'
text('plain', '.obj', V .. 'f 1 2 3 4\n')
text('all', '.obj', V .. T .. N .. 'f 1/1/1 2/2/1 3/3/1 4/4/1\n')
text('negative', '.obj', V .. T .. N .. 'f -4/-4/-1 -3/-3/-1 -2/-2/-1\nf -4//-1 -2//-1 -1//-1\n')
text('joined', '.obj', 'v 0 0 \\\n0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 \\\n3 4\n')
text('coloured', '.obj', V:gsub(' 0\n', ' 0 .25 .5 .75\n') .. 'f 1 2 3 4\n', KD)
text('bytes', '.obj', V:gsub(' 0\n', ' 0 64 128 191\n') .. 'f 1 2 3 4\n', KD)
text('normal', '.obj', V .. N .. 'f 1//9 2//1 3//1 4//1\n', nil, 'normal')
text('corner', '.obj', V .. 'f 1 2\nf 1 2 3 4\n', nil, 'at least 3')
text('unused', '.obj', V .. 'v nan 0 0\nf 1 2 3 4\n', nil, 'finite')
text('uv', '.obj', V .. T .. 'f 1/1 2/2 3/9 4/4\n', nil, 'coordinate')
text('badnormal', '.obj', V .. 'vn nan 0 1\nf 1//1 2//1 3//1 4//1\n', nil, 'normal')
text('keyword', '.obj', V .. 'F 1 2 3 4\nf 1 2 3 4\n', nil, "'F'")
text('silent', '.obj', 'o a\ng b\ns 1\n' .. V .. 'f 1 2 3 4\n# end')
local function painted(name, mtl, right, warning)
    write(name .. '.mtl', 'newmtl a\n' .. mtl)
    case(name .. '.obj', 'mtllib ' .. name .. '.mtl\n' .. V .. T .. 'usemtl a\nf 1/1 2/2 3/3 4/4\n', right, warning)
end
painted('kd', 'Kd .25 .5 .75\n', KD)
painted('crlf', 'Kd .25 .5 .75\r\nd 1\r\n', KD)
painted('tr_one', 'Kd .25 .5 .75\nTr 1\n', KD, 'tr_one.mtl:Tr')
painted('tr_d', 'Kd .25 .5 .75\nTr 1\nd 1\n', KD)
painted('kd_nan', 'Kd nan 0 0\nKd .25 .5 .75\n', KD, 'kd_nan.mtl:finite')
painted('no_map', 'Kd .25 .5 .75\nmap_Kd\n', KD, 'no_map.mtl:name')
painted('no_file', 'Kd .25 .5 .75\nmap_Kd nothing.png\n', KD, 'no_file.mtl:nothing.png')
painted('no_lamp', 'Kd .25 .5 .75\nmap_Ke nothing.png\n', KD, 'no_lamp.mtl:nothing.png')

-- Pictures: the rows from below.
local picture = {{RED, GREEN}, {BLUE, GREY}}
local quarters = {RED, GREEN, BLUE, GREY}
local function rows(pixel, from_top, padding)
    local out = {}
    for y = 1, 2 do
        local row = picture[from_top and 3 - y or y]
        out[y] = pixel(row[1]) .. pixel(row[2]) .. (padding or '')
    end
    return table.concat(out)
end
local function whole(x) return (x * 255 + .5) // 1 end
local function bgr(c) return byte(whole(c[3]), whole(c[2]), whole(c[1])) end
local function bgra(c) return bgr(c) .. '\xff' end
local function index(c) return byte(c == RED and 0 or c == GREEN and 1 or c == BLUE and 2 or 3) end
local palette = {bgra(RED), bgra(GREEN), bgra(BLUE), bgra(GREY)}
local function shown(name, bytes, right, warning)
    write(name, bytes)
    painted((name:gsub('%.', '_')), 'Kd .25 .5 .75\nmap_Kd ' .. name .. '\n', right or not warning and {
        {.25, 0, 0}, {0, .5, 0}, {0, 0, .75}, {.1, .2, .3}} or KD, warning)
end
local function bmp(bits, height, colours, data)
    local start = 54 + #colours
    return 'BM' .. pack('<I4I4I4I4i4i4I2I2I4I4i4i4I4I4', start + #data, 0, start, 40, 2, height, 1, bits, 0, #data, 0, 0,
        #colours // 4, 0) .. colours .. data
end
shown('b24.bmp', bmp(24, 2, '', rows(bgr, false, '\0\0')))
shown('b24top.bmp', bmp(24, -2, '', rows(bgr, true, '\0\0')))
shown('b32.bmp', bmp(32, 2, '', rows(bgra)))
shown('b8.bmp', bmp(8, 2, table.concat(palette), rows(index, false, '\0\0')))
shown('b4.bmp', bmp(4, 2, table.concat(palette), '\x01\0\0\0\x23\0\0\0'))
local function tga(kind, bits, flags, colours, data)
    local map = #colours > 0 and 1 or 0
    return pack('<BBBI2I2BI2I2I2I2BB', 0, map, kind, 0, #colours // 3, map * 24, 0, 0, 2, 2, bits, flags) .. colours .. data
end
local small = bgr(RED) .. bgr(GREEN) .. bgr(BLUE) .. bgr(GREY)
shown('t24.tga', tga(2, 24, 0, '', rows(bgr)))
shown('t24top.tga', tga(2, 24, 0x20, '', rows(bgr, true)))
shown('t32.tga', tga(2, 32, 8, '', rows(bgra)))
shown('trle.tga', tga(10, 24, 0, '', '\x01' .. rows(bgr):sub(1, 6) .. '\x80' .. bgr(BLUE) .. '\x80' .. bgr(GREY)))
shown('t8.tga', tga(1, 8, 0, small, rows(index)))
shown('tgrey.tga', tga(3, 8, 0, '', '\x66\x66\x66\x66'), {.1, .2, .3})
local function floats(order) return function(c) return pack(order .. 'fff', c[1], c[2], c[3]) end end
shown('little.pfm', 'PF\n2 2\n-1.0\n' .. rows(floats '<'))
shown('big.pfm', 'PF\n2 2\n1.0\n' .. rows(floats '>'))
shown('crlf.pfm', 'PF\r\n2 2\r\n-1.0\r\n' .. rows(floats '<'))
shown('comment.pfm', 'PF\n# made by hand\n2 2\n-1.0\n' .. rows(floats '<'))
local function rgbe(c) return byte(c[1] * 128 // 1, c[2] * 128 // 1, c[3] * 128 // 1, 129) end
for word, line_end in pairs{lf = '\n', crlf = '\r\n'} do
    shown(word .. '.hdr', ('#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 2\n'):gsub('\n', line_end) .. rows(rgbe, true))
end
local function half(x) return x == 1 and 0x3c00 or x == 0 and 0 or 0x3666 end
local function exr(kind, tiled, window, order)
    local function attribute(name, of, value) return pack('<zzs4', name, of, value) end
    local channels = {}
    for k = 1, 3 do channels[k] = pack('<zi4I4i4i4', ('BGR'):sub(k, k), kind, 0, 1, 1) end
    local head = '\x76\x2f\x31\x01' .. pack('<I4', tiled and 0x202 or 2) ..
        attribute('channels', 'chlist', table.concat(channels) .. '\0') .. attribute('compression', 'compression', '\0') ..
        attribute('dataWindow', 'box2i', pack('<i4i4i4i4', window, window, window + 1, window + 1)) ..
        attribute('displayWindow', 'box2i', pack('<i4i4i4i4', window, window, window + 1, window + 1)) ..
        attribute('lineOrder', 'lineOrder', byte(order)) .. attribute('pixelAspectRatio', 'float', pack('<f', 1)) ..
        attribute('screenWindowCenter', 'v2f', pack('<ff', 0, 0)) ..
        attribute('screenWindowWidth', 'float', pack('<f', 1)) ..
        (tiled and attribute('tiles', 'tiledesc', pack('<I4I4B', 2, 2, 0)) or '') .. '\0'
    local lines = {}
    for y = 1, 2 do
        local row, line = picture[3 - y], {}
        for k = 3, 1, -1 do
            for x = 1, 2 do line[#line + 1] = kind == 1 and pack('<I2', half(row[x][k])) or pack('<f', row[x][k]) end
        end
        lines[y] = table.concat(line)
    end
    if tiled then
        local data = table.concat(lines)
        return head .. pack('<I8', #head + 8) .. pack('<i4i4i4i4s4', 0, 0, 0, 0, data)
    end
    local size = 8 + #lines[1]
    local out = head .. pack('<I8I8', #head + 16 + order * size, #head + 16 + (1 - order) * size)
    for k = 1, 2 do
        local y = order == 1 and 3 - k or k
        out = out .. pack('<i4s4', window + y - 1, lines[y])
    end
    return out
end
for kind, word in pairs{'half', 'float'} do
    shown(word .. '.exr', exr(kind, false, 0, 0))
    shown(word .. '_tiled.exr', exr(kind, true, 0, 0))
    shown(word .. '_window.exr', exr(kind, false, -7, 0))
    shown(word .. '_upward.exr', exr(kind, false, 3, 1))
end
shown('no.gif', 'GIF89a\1\0\1\0\0\0\0;', nil, 'no.gif:GIF')
shown('no.tiff', 'II*\0\8\0\0\0\0\0\0\0', nil, 'no.tiff:TIFF')
shown('cut.bmp', bmp(24, 2, '', rows(bgr, false, '\0\0')):sub(1, 60), nil, 'cut.bmp:early')

-- PLY: vertices with these further properties, faces of this kind, in text and both byte orders.
local corners = {{0, 0}, {1, 0}, {1, 1}, {0, 1}}
local function ply(name, before, after, values, face_after, face_values, right, warning)
    local function header(format)
        return 'ply\nformat ' .. format .. ' 1.0\ncomment by hand\nelement vertex 4\n' .. before ..
            'property float x\nproperty float y\nproperty float z\n' .. after ..
            'element face 1\nproperty list uchar int vertex_indices\n' .. face_after .. 'end_header\n'
    end
    local function pieces(head, tail)
        local all = {}
        for _, piece in ipairs(head) do all[#all + 1] = piece end
        for _, piece in ipairs(tail) do all[#all + 1] = piece end
        return all
    end
    local head = before ~= '' and {{'h', 7}} or {}
    local function body(one)
        local out = {}
        for _, c in ipairs(corners) do
            out[#out + 1] = one(pieces(pieces(head, {{'f', c[1]}, {'f', c[2]}, {'f', 0}}), values))
        end
        out[#out + 1] = one(pieces({{'B', 4}, {'i4', 0}, {'i4', 1}, {'i4', 2}, {'i4', 3}}, face_values))
        return table.concat(out)
    end
    text(name, '.ply', header 'ascii' .. body(function(list)
        local words = {}
        for k, piece in ipairs(list) do words[k] = tostring(piece[2]) end
        return table.concat(words, ' ') .. '\n'
    end), right, warning)
    for word, order in pairs{little = '<', big = '>'} do
        case(name .. '-' .. word .. '.ply', header('binary_' .. word .. '_endian') .. body(function(list)
            local out = {}
            for k, piece in ipairs(list) do out[k] = pack(order .. piece[1], piece[2]) end
            return table.concat(out)
        end), right, warning)
    end
end
local uchar = 'property uchar red\nproperty uchar green\nproperty uchar blue\n'
local float = uchar:gsub('uchar', 'float')
local in_bytes, in_floats = {{'B', 64}, {'B', 128}, {'B', 191}}, {{'f', .25}, {'f', .5}, {'f', .75}}
ply('bare', '', '', {}, '', {})
ply('before', 'property short weight\n', '', {}, '', {})
ply('red', '', uchar, in_bytes, '', {}, KD)
ply('redf', 'property short weight\n', float, in_floats, '', {}, KD)
ply('face', '', '', {}, uchar, in_bytes, KD)
ply('facef', '', '', {}, float, in_floats, KD)
ply('normals', '', 'property float nx\nproperty float ny\nproperty float nz\n', {{'f', 0}, {'f', 0}, {'f', 1}}, '', {})

-- STL.
local F = 'facet normal 0 0 1\nouter loop\n%send loop\nendfacet\n'
local one = F:format 'vertex 0 0 0\nvertex 1 0 0\nvertex 1 1 0\n'
local two = one .. F:format 'vertex 0 0 0\nvertex 1 1 0\nvertex 0 1 0\n'
text('loop', '.stl', 'solid a\n' .. two .. 'endsolid a\n')
text('endloop', '.stl', 'solid a\n' .. two:gsub('end loop', 'endloop') .. 'end solid a\n')
text('upper', '.stl', ('solid a\n' .. two .. 'endsolid a\n'):upper())
text('endless', '.stl', 'solid a\n' .. two)
text('doubled', '.stl', 'solid a\nsolid a\n' .. two .. 'endsolid a\nendsolid a\n')
text('several', '.stl', 'solid a\n' .. one .. 'endsolid a\nsolid b\n' .. two:sub(#one + 1) .. 'endsolid b\n')
text('nul', '.stl', 'solid a\n' .. two .. 'endsolid a\n\0\0\26')
local function stl(head, count, attribute)
    local function triangle(...) return pack('<fff', 0, 0, 1) .. bytes_of('<f', {...}) .. pack('<I2', attribute) end
    return head .. ('\0'):rep(80 - #head) .. pack('<I4', count) ..
        triangle(0, 0, 0, 1, 0, 0, 1, 1, 0) .. triangle(0, 0, 0, 1, 1, 0, 0, 1, 0)
end
case('binary.stl', stl('', 2, 0))
case('solid.stl', stl('solid a', 2, 0))
case('beyond.stl', stl('', 1, 0), nil, 'triangles')
case('cut.stl', stl('', 3, 0) .. ('\0'):rep(20), nil, 'triangle')
case('viscam.stl', stl('', 2, 0x8000 | 8 << 10 | 16 << 5 | 23), {8 / 31, 16 / 31, 23 / 31})
case('magics.stl', stl('COLOR=\64\128\191\255', 2, 0x8000), KD)

-- glTF.
local function base64(data)
    local letters, out = 'ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/', {}
    for a, b, c in (data .. ('\0'):rep(-#data % 3)):gmatch '(.)(.)(.)' do
        local n = a:byte() << 16 | b:byte() << 8 | c:byte()
        for shift = 18, 0, -6 do
            local k = (n >> shift & 63) + 1
            out[#out + 1] = letters:sub(k, k)
        end
    end
    local tail = -#data % 3
    return table.concat(out, '', 1, #out - tail) .. ('='):rep(tail)
end
local components = {b = {5120, 'b', 127}, B = {5121, 'B', 255}, h = {5122, 'h', 32767}, H = {5123, 'H', 65535},
    I = {5125, 'I4', 1}, f = {5126, 'f', 1}}
local orders = {[4] = {1, 2, 3, 1, 3, 4}, [5] = {1, 2, 4, 3}, [6] = {1, 2, 3, 4}}
-- o: mode, kind of positions, indices and colours; JSON of the material, node, primitive and top level; glb.
local function gltf(name, o, right, warning)
    local data, views, accessors, attributes = '', {}, {}, {}
    local function accessor(kind, size, numbers, stays)
        local c, list = components[kind], {}
        for k, x in ipairs(numbers) do list[k] = stays and x or kind == 'f' and x or (x * c[3] + .5) // 1 end
        local lines, element, stride = {}, #pack('<' .. c[2], 0), nil
        stride = stays and element or (element * size + 3) // 4 * 4
        for k = 1, #list, size do
            local line = bytes_of('<' .. c[2], table.move(list, k, k + size - 1, 1, {}))
            lines[#lines + 1] = line .. ('\0'):rep(stride - #line)
        end
        local at = #data
        data = data .. table.concat(lines)
        data = data .. ('\0'):rep(-#data % 4)
        views[#views + 1] = ('{"buffer":0,"byteOffset":%d,"byteLength":%d%s}'):format(at, stride * #lines,
            stays and '' or ',"byteStride":' .. stride)
        accessors[#accessors + 1] = ('{"bufferView":%d,"componentType":%d,"count":%d,"type":"%s"%s%s}'):format(#views - 1,
            c[1], #lines, ({'SCALAR', 'VEC2', 'VEC3', 'VEC4'})[size],
            not stays and kind ~= 'f' and ',"normalized":true' or '',
            size == 3 and #accessors == 0 and ',"min":[0,0,0],"max":[1,1,0]' or '')
        return #accessors - 1
    end
    local order, places, paint, uv, indices = orders[o.mode or 4], {}, {}, {}, {}
    for k, at in ipairs(order) do
        local from = o.index and k <= 4 and corners[k] or not o.index and corners[at] or nil
        for d = 1, from and 3 or 0 do
            places[#places + 1], paint[#paint + 1] = d < 3 and from[d] or 0, KD[d]
            if d < 3 then uv[#uv + 1] = d == 2 and 1 - from[2] or from[1] end
        end
        if from and (o.colour or ''):sub(2) == '4' then paint[#paint + 1] = 1 end
        indices[k] = at - 1
    end
    attributes[1] = '"POSITION":' .. accessor(o.position or 'f', 3, places)
    if o.colour then attributes[2] = '"COLOR_0":' .. accessor(o.colour:sub(1, 1), tonumber(o.colour:sub(2)), paint) end
    if o.second then attributes[#attributes + 1] = '"TEXCOORD_0":' .. accessor('f', 2, {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0}) end
    if o.uv then attributes[#attributes + 1] = ('"TEXCOORD_%d":'):format(o.second and 1 or 0) .. accessor(o.uv, 2, uv) end
    local primitive = ('{"attributes":{%s},"mode":%d,"material":0%s%s}'):format(table.concat(attributes, ','), o.mode or 4,
        o.index and ',"indices":' .. accessor(o.index, 1, indices, true) or '', o.primitive or '')
    local function json(buffer)
        return ('{"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0%s}],"meshes":[' ..
            '{"primitives":[%s]%s}],"materials":[%s],"accessors":[%s],"bufferViews":[%s],"buffers":[{"byteLength":%d%s}]%s}')
            :format(o.node or '', primitive, o.mesh or '', o.material or
            '{"extensions":{"KHR_materials_unlit":{}},"pbrMetallicRoughness":{"baseColorFactor":[' ..
            (o.colour and '1,1,1' or '0.25,0.5,0.75') .. ',1]}}', table.concat(accessors, ','), table.concat(views, ','),
            #data, buffer, o.top or '')
    end
    case(name .. '.gltf', json(',"uri":"data:application/octet-stream;base64,' .. base64(data) .. '"'), right or KD, warning)
    local text_chunk = json ''
    text_chunk = text_chunk .. (' '):rep(-#text_chunk % 4)
    case(name .. '.glb', 'glTF' .. pack('<I4I4', 2, 28 + #text_chunk + #data) .. pack('<I4', #text_chunk) .. 'JSON' ..
        text_chunk .. pack('<I4', #data) .. 'BIN\0' .. data, right or KD, warning)
end
for mode = 4, 6 do
    gltf('m' .. mode, {mode = mode})
    for _, index_kind in ipairs{'B', 'H', 'I'} do gltf('m' .. mode .. index_kind, {mode = mode, index = index_kind}) end
end
local quantised = ',"extensionsUsed":["KHR_mesh_quantization"],"extensionsRequired":["KHR_mesh_quantization"]'
for _, kind in ipairs{'b', 'B', 'h', 'H'} do gltf('q_' .. (kind == kind:lower() and 's' or 'u') .. kind, {position = kind, top = quantised}) end
for _, kind in ipairs{'f3', 'f4', 'B3', 'B4', 'H3', 'H4'} do gltf('c' .. kind, {colour = kind}) end
gltf('two_sided', {node = ',"rotation":[0,0,0,1],"scale":[1,1,1],"translation":[0,0,0]'})
gltf('matrix', {node = ',"matrix":[1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1]'})
gltf('flat', {node = ',"scale":[1,1,0]'})
gltf('optional', {top = ',"extensionsUsed":["VENDOR_nothing"]', node = ',"extensions":{"VENDOR_nothing":{}}'}, KD, 'VENDOR_nothing')
gltf('extras', {primitive = ',"extras":{"a":[1]}'})
gltf('targets', {primitive = ',"targets":[{"POSITION":0}]', mesh = ',"weights":[0]'})
write('quarters.bmp', bmp(24, 2, '', rows(bgr, false, '\0\0')))
local function mapped(name, kind, further, right, second)
    gltf(name, {uv = kind, second = second, top = ',"textures":[{"source":0}],"images":[{"uri":"quarters.bmp"}]',
        material = '{"extensions":{"KHR_materials_unlit":{}},"pbrMetallicRoughness":{"baseColorTexture":{"index":0' ..
        further .. '}}}'}, right)
end
for _, kind in ipairs{'f', 'B', 'H'} do
    mapped('map_' .. kind:lower(), kind, '', quarters)
    mapped('second_' .. kind:lower(), kind, ',"texCoord":1', quarters, true)
end
local function turned(name, transform, right)
    mapped(name, 'f', ',"extensions":{"KHR_texture_transform":{' .. transform .. '}}', right)
end
turned('right', '"offset":[0.5,0]', {GREEN, RED, GREY, BLUE})
turned('up', '"offset":[0,0.5]', {BLUE, GREY, RED, GREEN})
turned('mirrored', '"scale":[-1,1]', {GREEN, RED, GREY, BLUE})
-- (u, v) to (v, -u), v downwards: counterclockwise
turned('quarter', '"rotation":1.5707963267948966', {GREEN, GREY, RED, BLUE})
turned('half', '"rotation":3.1415926535897932', {GREY, BLUE, GREEN, RED})
gltf('no_picture', {uv = 'f', top = ',"textures":[{"source":0}],"images":[{"uri":"nothing.png"}]',
    material = '{"extensions":{"KHR_materials_unlit":{}},"pbrMetallicRoughness":{"baseColorFactor":[0.25,0.5,0.75,1],' ..
    '"baseColorTexture":{"index":0}}}'}, KD, 'nothing.png')

-- Reads all, and renders all in one picture.
local ROW, SIDE, EDGE = 20, 10, math.ceil(#cases / 20)
local root, plain, bad = gr.node('all'), gr.material({.1, .2, .3}, {0, 0, 0}, 1), {}
for k, file in ipairs(cases) do
    local done, mesh = pcall(gr.mesh, {file = file.name, material = not file.right and plain or nil})
    if done then
        local _, faces = mesh:faces()
        local triangles = 0
        for _, face in ipairs(faces) do triangles = triangles + #face - 2 end
        if triangles ~= file.triangles then bad[#bad + 1] = file.name .. ' has ' .. triangles .. ' triangles' end
        local cell = gr.node{children = {mesh}}
        cell:translate((k - 1) % ROW, (k - 1) // ROW, 0)
        root:add_child(cell)
        if file.warning then
            local of, words = file.warning:match('^(.*):(.*)$')
            print((of or file.name) .. '\t' .. (words or file.warning))
        end
    else
        bad[#bad + 1] = mesh
    end
end
gr.render{node = root, file = 'all.pfm', width = ROW * SIDE, height = EDGE * SIDE, eye = {ROW / 2, EDGE / 2, 5},
    view = {0, 0, -1}, projection = 'orthographic', view_height = EDGE, ambient = {1, 1, 1}, lights = {}}
local file = assert(io.open('all.pfm', 'rb'))
local pixels = file:read('a'):sub(-ROW * EDGE * SIDE * SIDE * 12)
file:close()
for k, c in ipairs(cases) do
    for quarter = 0, 3 do
        local x, y = (k - 1) % ROW * SIDE + 2 + quarter % 2 * 5, (k - 1) // ROW * SIDE + 2 + quarter // 2 * 5
        local seen = {string.unpack('<fff', pixels, (y * ROW * SIDE + x) * 12 + 1)}
        local right = c.right or {.1, .2, .3}
        local slack = .01
        if type(right[1]) == 'table' then right, slack = right[quarter + 1], .1 end -- pictures are filtered
        for d = 1, 3 do
            if math.abs(seen[d] - right[d]) > slack then
                bad[#bad + 1] = ('%s: colour %g %g %g in quarter %d, right: %g %g %g'):format(c.name, seen[1], seen[2], seen[3],
                    quarter, right[1], right[2], right[3])
                break
            end
        end
    end
end
if #bad > 0 then error(table.concat(bad, '\n'), 0) end
print(#cases .. ' files')
