-- What several demos share: boxes and balls by position, a floor, a checkered floor.
-- Author: gray project

local M = {}

--- A cube stretched from one corner to the other.
function M.box(name, material, low, high)
    local node = gr.geometry(name, gr.cube(material))
    node:scale(high[1] - low[1], high[2] - low[2], high[3] - low[3])
    node:translate(low[1], low[2], low[3])
    return node
end

--- A sphere by centre and radius.
function M.ball(name, material, centre, radius)
    local node = gr.geometry(name, gr.sphere(material))
    node:scale(radius, radius, radius)
    node:translate(centre[1], centre[2], centre[3])
    return node
end

--- A mesh with normals, from the four tables that the library's modules return.
function M.smooth(name, material, ...)
    return gr.geometry(name, gr.vn_mesh(material, ...))
end

--- A floor of squares in two materials, top at y = 0, as two meshes.
function M.checkers(name, dark, light, x0, z0, x1, z1, size)
    local floor = gr.node(name)
    for k, material in ipairs { dark, light } do
        local verts, faces = {}, {}
        for i = 0, math.ceil((x1 - x0) / size) - 1 do
            for j = 0, math.ceil((z1 - z0) / size) - 1 do
                if (i + j) % 2 == k - 1 then
                    local x, z, n = x0 + i * size, z0 + j * size, #verts
                    verts[n + 1], verts[n + 2] = { x, 0, z }, { x, 0, z + size }
                    verts[n + 3], verts[n + 4] = { x + size, 0, z + size }, { x + size, 0, z }
                    faces[#faces + 1] = { n, n + 1, n + 2, n + 3 }
                end
            end
        end
        floor:add_child(gr.geometry(name .. k, gr.mesh(material, verts, faces)))
    end
    return floor
end

return M
