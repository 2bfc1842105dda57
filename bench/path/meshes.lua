-- Prints the meshes of bench/denoise/mesh_sky.lua, as they stand there, as Wavefront OBJ.
local first = 1 -- OBJ counts the vertices of all objects
local function show(name, verts, faces, factor, move)
    print('o ' .. name)
    for _, v in ipairs(verts) do
        print(('v %.9g %.9g %.9g'):format(v[1] * factor + move[1], v[2] * factor + move[2], v[3] * factor + move[3]))
    end
    for _, face in ipairs(faces) do
        local words = { 'f' }
        for _, corner in ipairs(face) do words[#words + 1] = tostring(corner + first) end
        print(table.concat(words, ' '))
    end
    first = first + #verts
end
local verts, _, faces = require('knot').mesh(2, 3, { n = 200, around = 16, radius = .2 })
show('knot', verts, faces, 1, { -1.1, .62, 0 })
verts, _, faces = require('teapot').mesh(8)
show('pot', verts, faces, .42, { 1.3, 0, .2 })
