-- Twin of bunny.pov. MODEL is the OBJ file (-D MODEL=...); with the global EXPORT (-D EXPORT=mesh.inc) it does not
-- render: it prints the mesh in POV-Ray's language, with the same area-weighted vertex normals.
local verts, faces = require('readobj')(MODEL)
local low, high = {math.huge, math.huge, math.huge}, {-math.huge, -math.huge, -math.huge}
for _, v in ipairs(verts) do
    for k = 1, 3 do
        low[k], high[k] = math.min(low[k], v[k]), math.max(high[k], v[k])
    end
end
local size = 2 / (high[2] - low[2])
local normals = {}
for i, v in ipairs(verts) do
    verts[i] = {(v[1] - (low[1] + high[1]) / 2) * size, (v[2] - low[2]) * size, (v[3] - (low[3] + high[3]) / 2) * size}
    normals[i] = {0, 0, 0}
end
for _, f in ipairs(faces) do
    local a, b, c = verts[f[1] + 1], verts[f[2] + 1], verts[f[3] + 1]
    local x1, y1, z1 = b[1] - a[1], b[2] - a[2], b[3] - a[3]
    local x2, y2, z2 = c[1] - a[1], c[2] - a[2], c[3] - a[3]
    local nx, ny, nz = y1 * z2 - z1 * y2, z1 * x2 - x1 * z2, x1 * y2 - y1 * x2
    for _, i in ipairs(f) do
        local n = normals[i + 1]
        n[1], n[2], n[3] = n[1] + nx, n[2] + ny, n[3] + nz
    end
end
for _, n in ipairs(normals) do
    local length = math.sqrt(n[1] ^ 2 + n[2] ^ 2 + n[3] ^ 2)
    if length > 0 then
        n[1], n[2], n[3] = n[1] / length, n[2] / length, n[3] / length
    else
        n[2] = 1
    end
end

if EXPORT then
    local function list(title, rows)
        io.write(title, ' { ', #rows)
        for _, row in ipairs(rows) do
            io.write(string.format(',\n<%.9g,%.9g,%.9g>', row[1], row[2], row[3]))
        end
        io.write(' }\n')
    end
    local function mirrored(rows)
        local out = {}
        for i, row in ipairs(rows) do
            out[i] = {row[1], row[2], -row[3]}
        end
        return out
    end
    io.write('#declare Mesh = mesh2 {\n')
    list('vertex_vectors', mirrored(verts))
    list('normal_vectors', mirrored(normals))
    list('face_indices', faces)
    io.write('}\n')
    return
end

local scene = gr.node('scene')
local fur = gr.rr_material({0.6, 0.525, 0.4125}, {0.5, 0.5, 0.5}, 40, 0.16, 0, 1)
scene:add_child(gr.geometry('mesh', gr.vn_mesh(fur, verts, normals, faces, faces)))
local floor_look = gr.td_cube_material{material = gr.rr_material({0.5, 0.5, 0.5}, {0.1, 0.1, 0.1}, 1000000, 1, 0, 1), png = 'checker32.png', filter = 'nearest'}
scene:add_child(gr.nh_box(floor_look, {-8, -16, -8}, 16))
local lamps = {
    gr.light({5, 7, 6}, {0.85, 0.85, 0.85}, {1, 0, 0}),
    gr.light({-6, 5, 3}, {0.25, 0.28, 0.35}, {1, 0, 0}),
}
local vertical = math.deg(2 * math.atan(math.tan(math.rad(19)) * 3 / 4))
gr.render{node = scene, file = 'bunny.png', width = 640, height = 480, eye = {0.4, 1.9, 4.2}, view = {-0.4, -0.95, -4.2},
          up = {0, 1, 0}, fov = vertical, ambient = {0.107, 0.107, 0.107}, lights = lamps, background = {0.3, 0.35, 0.45}}
