-- TITLE: The model files of meshes.lua
-- Writes rocket.obj with rocket.mtl, knot.ply, gear.stl and crate.gltf beside itself, one of each format.
-- Author: gray project
--
-- Run: lua5.4 data/models/make.lua, or ./gray --allow-write data/models data/models/make.lua

local here = (debug.getinfo(1, 'S').source:match('^@(.*/)') or './')
package.path = here .. '../../lua/?.lua;' .. package.path

local knot = require 'knot'

local sin, cos, pi = math.sin, math.cos, math.pi

local function save(name, text)
    local handle = assert(io.open(here .. name, 'wb'))
    handle:write(text)
    handle:close()
end

-- A rocket: rings of a profile with uv, in parts by usemtl.
local out, count = { '# a rocket in five parts (gray project)', 'mtllib rocket.mtl' }, 0
local function turned(material, profile, around)
    out[#out + 1] = 'usemtl ' .. material
    local length, rows = 0, #profile
    for i, p in ipairs(profile) do
        if i > 1 then length = length + math.sqrt((p[1] - profile[i - 1][1]) ^ 2 + (p[2] - profile[i - 1][2]) ^ 2) end
        for k = 0, around do
            local a = 2 * pi * k / around
            out[#out + 1] = ('v %.4f %.4f %.4f'):format(p[1] * sin(a), p[2], p[1] * cos(a))
            out[#out + 1] = ('vt %.4f %.4f'):format(k / around, length / 3)
        end
    end
    for i = 0, rows - 2 do
        for k = 0, around - 1 do
            local a, b = count + i * (around + 1) + k + 1, count + (i + 1) * (around + 1) + k + 1
            out[#out + 1] = ('f %d/%d %d/%d %d/%d %d/%d'):format(a, a, a + 1, a + 1, b + 1, b + 1, b, b)
        end
    end
    count = count + rows * (around + 1)
end
local function hull(y)
    return .62 * sin(pi * math.min(1, (y + .55) / 3.6)) ^ .7
end
local profile = {}
for i = 0, 12 do profile[i + 1] = { hull(i / 12 * 1.9), .5 + i / 12 * 1.9 } end
turned('hull', profile, 24)
local nose = {}
for i = 0, 8 do nose[i + 1] = { hull(1.9) * cos(pi / 2 * i / 8), 2.4 + .85 * sin(pi / 2 * i / 8) } end
turned('nose', nose, 24)
turned('jet', { { .30, .25 }, { .27, .4 }, { .38, .5 }, { hull(0), .5 } }, 24)
turned('flame', { { .0, -.25 }, { .12, -.05 }, { .2, .15 }, { .16, .32 }, { 0, .38 } }, 16)
out[#out + 1] = 'usemtl fins'
for k = 0, 2 do
    local a = 2 * pi * k / 3 + .3
    local x, z, across = sin(a), cos(a), .035
    local outline = { { .42, 1.25 }, { .95, .55 }, { 1.0, -.2 }, { .82, .1 }, { .42, .55 } }
    for side = -1, 1, 2 do
        for _, p in ipairs(outline) do
            out[#out + 1] = ('v %.4f %.4f %.4f'):format(p[1] * x + side * across * z, p[2], p[1] * z - side * across * x)
        end
    end
    local function face(list)
        for i, n in ipairs(list) do list[i] = count + n end
        out[#out + 1] = 'f ' .. table.concat(list, ' ')
    end
    face { 1, 2, 3, 4, 5 }
    face { 10, 9, 8, 7, 6 }
    for i = 1, 5 do
        local j = i % 5 + 1
        face { i, i + 5, j + 5, j }
    end
    count = count + 10
end
save('rocket.obj', table.concat(out, '\n') .. '\n')
save('rocket.mtl', [[
# The parts of rocket.obj (gray project)
newmtl hull
Kd 0.75 0.76 0.78
Ks 0.35 0.35 0.35
Ns 60
illum 2
map_Bump -bm 0.6 -s 8 6 1 ../../textures/bricks_height.png
newmtl nose
Kd 0.70 0.10 0.08
Ks 0.5 0.5 0.5
Ns 90
illum 2
newmtl jet
Kd 0.20 0.20 0.22
Ks 0.4 0.4 0.4
Ns 30
illum 2
newmtl flame
Kd 0 0 0
Ke 1.0 0.62 0.15
newmtl fins
Kd 0.12 0.22 0.45
Ks 0.4 0.4 0.4
Ns 60
illum 2
]])

-- A knot with a colour at every vertex: binary PLY.
local mesh = { knot.mesh(2, 3, { n = 144, around = 12 }) }
local verts, faces = mesh[1], mesh[3]
local ply = { ('ply\nformat binary_little_endian 1.0\ncomment a trefoil (gray project)\nelement vertex %d\n' ..
    'property float x\nproperty float y\nproperty float z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\n' ..
    'element face %d\nproperty list uchar ushort vertex_indices\nend_header\n'):format(#verts, #faces) }
for _, v in ipairs(verts) do
    local a = math.atan(v[3], v[1])
    local function wave(shift) return math.floor(140 + 110 * sin(3 * a / 2 + shift)) end
    ply[#ply + 1] = ('<fffBBB'):pack(v[1], v[2], v[3], wave(0), wave(2.1), wave(4.2))
end
for _, f in ipairs(faces) do
    ply[#ply + 1] = ('<B'):pack(#f)
    for _, n in ipairs(f) do ply[#ply + 1] = ('<I2'):pack(n) end
end
save('knot.ply', table.concat(ply))

-- A gear wheel as triangles without any connection: binary STL.
local stl, triangles = {}, 0
local function triangle(a, b, c)
    stl[#stl + 1] = ('<ffffffffffffI2'):pack(0, 0, 0, a[1], a[2], a[3], b[1], b[2], b[3], c[1], c[2], c[3], 0)
    triangles = triangles + 1
end
local rim = {}
for tooth = 0, 17 do
    for _, step in ipairs { { 0, .82 }, { .22, .82 }, { .34, 1 }, { .62, 1 }, { .74, .82 } } do
        local a = 2 * pi * (tooth + step[1]) / 18
        rim[#rim + 1] = { cos(a), sin(a), step[2] }
    end
end
for i = 1, #rim do
    local p, q = rim[i], rim[i % #rim + 1]
    local function at(r, d, z) return { d[1] * r, d[2] * r, z } end
    local corners = {}
    for _, d in ipairs { p, q } do
        corners[#corners + 1] = { at(d[3], d, .18), at(d[3], d, -.18), at(.3, d, -.18), at(.3, d, .18) }
    end
    local a, b = corners[1], corners[2]
    for k = 1, 4 do
        local n = k % 4 + 1
        triangle(a[k], a[n], b[n])
        triangle(a[k], b[n], b[k])
    end
end
save('gear.stl', ('<c80I4'):pack('gear wheel (gray project)', triangles) .. table.concat(stl))

-- A crate with a picture and a normal map: glTF with an embedded buffer.
local digits = 'ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/'
local function base64(data)
    local text = {}
    for i = 1, #data, 3 do
        local a, b, c = data:byte(i, i + 2)
        local bits = a << 16 | (b or 0) << 8 | (c or 0)
        for k = 0, 3 do
            local d = bits >> (18 - 6 * k) & 63
            text[#text + 1] = (k == 2 and not b or k == 3 and not c) and '=' or digits:sub(d + 1, d + 1)
        end
    end
    return table.concat(text)
end
local positions, normals, uvs, indices, n = {}, {}, {}, {}, 0
for axis = 0, 2 do
    for side = -1, 1, 2 do
        local normal = { 0, 0, 0 }
        normal[axis + 1] = side
        -- u to the right and v down, seen from outside
        local up = axis == 1 and { 0, 0, -side } or { 0, 1, 0 }
        local right = { up[2] * normal[3] - up[3] * normal[2], up[3] * normal[1] - up[1] * normal[3], up[1] * normal[2] - up[2] * normal[1] }
        for k, c in ipairs { { -1, -1 }, { 1, -1 }, { 1, 1 }, { -1, 1 } } do
            local p = {}
            for i = 1, 3 do p[i] = (normal[i] + c[1] * right[i] + c[2] * up[i]) / 2 end
            positions[#positions + 1] = ('<fff'):pack(p[1], p[2], p[3])
            normals[#normals + 1] = ('<fff'):pack(normal[1], normal[2], normal[3])
            uvs[#uvs + 1] = ('<ff'):pack((c[1] + 1) / 2, (1 - c[2]) / 2)
        end
        for _, k in ipairs { 0, 1, 2, 0, 2, 3 } do indices[#indices + 1] = ('<I2'):pack(n + k) end
        n = n + 4
    end
end
local buffer = table.concat(positions) .. table.concat(normals) .. table.concat(uvs) .. table.concat(indices)
save('crate.gltf', ([[
{"asset": {"version": "2.0", "generator": "gray project"}, "scene": 0, "scenes": [{"nodes": [0, 1]}],
 "nodes": [{"mesh": 0}, {"mesh": 0, "translation": [0.1, 0.8, 0.05], "rotation": [0, 0.2588, 0, 0.9659], "scale": [0.6, 0.6, 0.6]}],
 "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "NORMAL": 1, "TEXCOORD_0": 2}, "indices": 3, "material": 0}]}],
 "materials": [{"name": "crate", "pbrMetallicRoughness": {"baseColorTexture": {"index": 0}, "metallicFactor": 0, "roughnessFactor": 0.6},
   "normalTexture": {"index": 1, "scale": 0.6}}],
 "textures": [{"source": 0}, {"source": 1}],
 "images": [{"uri": "../../textures/tiles.png"}, {"uri": "../../textures/weave_normal.png"}],
 "accessors": [{"bufferView": 0, "componentType": 5126, "count": 24, "type": "VEC3"}, {"bufferView": 1, "componentType": 5126, "count": 24, "type": "VEC3"},
   {"bufferView": 2, "componentType": 5126, "count": 24, "type": "VEC2"}, {"bufferView": 3, "componentType": 5123, "count": 36, "type": "SCALAR"}],
 "bufferViews": [{"buffer": 0, "byteLength": 288}, {"buffer": 0, "byteOffset": 288, "byteLength": 288}, {"buffer": 0, "byteOffset": 576, "byteLength": 192},
   {"buffer": 0, "byteOffset": 768, "byteLength": 72}],
 "buffers": [{"byteLength": %d, "uri": "data:application/octet-stream;base64,%s"}]}
]]):format(#buffer, base64(buffer)))
