-- A picture of an extension of glTF is its factor at each point: spheres that have their numbers from pictures of one
-- colour look like those that have them from factors.
local pack = string.pack
local function write(name, bytes)
    local file = assert(io.open(name, 'wb'))
    file:write(bytes)
    file:close()
end
-- A texel of red .25, green .5, blue .75, and one of alpha 51 / 255.
write('colour.pfm', 'PF\n1 1\n-1.0\n' .. pack('<fff', .25, .5, .75))
write('alpha.tga', pack('<BBBI2I2BI2I2I2I2BB', 0, 0, 2, 0, 0, 0, 0, 0, 1, 1, 32, 8) .. '\xff\xff\xff\x33')

-- A square with coordinates.
local data = pack('<ffffffffffff', -1, -1, 0, 1, -1, 0, 1, 1, 0, -1, 1, 0) .. pack('<ffffffff', 0, 0, 1, 0, 1, 1, 0, 1) ..
    pack('<BBBBBB', 0, 1, 2, 0, 2, 3) .. '\0\0'
local function model(name, extension, values)
    local json = ('{"asset":{"version":"2.0"},"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],"textures":[{"source":0},' ..
        '{"source":1}],"images":[{"uri":"colour.pfm"},{"uri":"alpha.tga"}],"materials":[{"pbrMetallicRoughness":{' ..
        '"baseColorFactor":[0.5,0.4,0.3,1],"metallicFactor":0,"roughnessFactor":0.4},"extensions":{"%s":{%s}}}],' ..
        '"meshes":[{"primitives":[{"attributes":{"POSITION":0,"TEXCOORD_0":1},"indices":2,"material":0}]}],' ..
        '"accessors":[{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3","min":[-1,-1,0],"max":[1,1,0]},' ..
        '{"bufferView":1,"componentType":5126,"count":4,"type":"VEC2"},{"bufferView":2,"componentType":5121,"count":6,' ..
        '"type":"SCALAR"}],"bufferViews":[{"buffer":0,"byteLength":48},{"buffer":0,"byteOffset":48,"byteLength":32},' ..
        '{"buffer":0,"byteOffset":80,"byteLength":6}],"buffers":[{"byteLength":88}]}'):format(extension, values)
    json = json .. (' '):rep(-#json % 4)
    write(name .. '.glb', 'glTF' .. pack('<I4I4', 2, 28 + #json + #data) .. pack('<I4', #json) .. 'JSON' .. json ..
        pack('<I4', #data) .. 'BIN\0' .. data)
    gr.render{node = gr.mesh{file = name .. '.glb'}, file = name .. '.pfm', width = 8, height = 8, eye = {.5, 1, 3},
        target = {0, 0, 0}, lights = {gr.light{position = {1, 2, 4}, colour = {1, 1, 1}}}, background = {.4, .6, .8},
        integrator = 'path', spp = 4}
    local file = assert(io.open(name .. '.pfm', 'rb'))
    local pixels = {string.unpack('<' .. ('f'):rep(192), file:read('a'), -768)}
    file:close()
    return pixels
end
local colour, alpha = '"%s":{"index":0}', '"%s":{"index":1}'
for name, row in pairs{
    specular = {'specular', alpha, 'specularTexture', '"specularFactor":0.2', '"specularFactor":1'},
    tint = {'specular', colour, 'specularColorTexture', '"specularColorFactor":[0.25,0.5,0.75]', '"specularFactor":1'},
    clear = {'transmission', colour, 'transmissionTexture', '"transmissionFactor":0.125', '"transmissionFactor":0.5'},
    coat = {'clearcoat', colour, 'clearcoatTexture', '"clearcoatFactor":0.25', '"clearcoatFactor":1'},
    rough = {'clearcoat', colour, 'clearcoatRoughnessTexture', '"clearcoatFactor":1,"clearcoatRoughnessFactor":0.25',
        '"clearcoatFactor":1,"clearcoatRoughnessFactor":0.5'},
    fuzz = {'sheen', alpha, 'sheenRoughnessTexture', '"sheenColorFactor":[1,1,1],"sheenRoughnessFactor":0.2',
        '"sheenColorFactor":[1,1,1],"sheenRoughnessFactor":1'}} do
    local extension = 'KHR_materials_' .. row[1]
    local right, without = model(name .. '_factor', extension, row[4]), model(name .. '_without', extension, row[5])
    local seen = model(name .. '_map', extension, row[5] .. ',' .. row[2]:format(row[3]))
    local change, off = 0, 0
    for k = 1, 192 do
        change, off = math.max(change, math.abs(right[k] - without[k])), math.max(off, math.abs(right[k] - seen[k]))
    end
    assert(off == 0 and change > .002, name)
end
