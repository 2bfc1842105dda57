-- TITLE: Dodecahedra
-- Pentagons given as tables of vertices and faces; each smaller one stands in the eye of a bigger one.
-- Author: gray project. Dialect: classic, OLD order (as gray detects from the vertex tables).

gr.transform_order('old')
local g = (1 + math.sqrt(5)) / 2
local h = 1 / g
local verts = {
    {-1, -1, -1}, {-1, -1, 1}, {-1, 1, -1}, {-1, 1, 1}, {1, -1, -1}, {1, -1, 1}, {1, 1, -1}, {1, 1, 1},
    {0, -h, -g}, {0, -h, g}, {0, h, -g}, {0, h, g}, {-h, -g, 0}, {-h, g, 0}, {h, -g, 0}, {h, g, 0},
    {-g, 0, -h}, {g, 0, -h}, {-g, 0, h}, {g, 0, h},
}
local faces = {
    {3, 11, 7, 15, 13}, {7, 19, 17, 6, 15}, {17, 4, 8, 10, 6}, {8, 0, 16, 2, 10}, {0, 12, 1, 18, 16}, {6, 10, 2, 13, 15},
    {2, 16, 18, 3, 13}, {18, 1, 9, 11, 3}, {4, 14, 12, 0, 8}, {11, 9, 5, 19, 7}, {19, 5, 14, 4, 17}, {1, 12, 14, 5, 9},
}

local colours = { {0.75, 0.3, 0.2}, {0.8, 0.6, 0.2}, {0.3, 0.55, 0.35}, {0.25, 0.4, 0.7}, {0.5, 0.3, 0.6}, {0.8, 0.8, 0.75} }
local scene = gr.node('scene')
local where = scene
for i = 1, table.getn(colours) do
    local d = gr.mesh('d' .. i, verts, faces)
    d:set_material(gr.material(colours[i], {0.4, 0.4, 0.4}, 30))
    where:add_child(d)
    -- the next one: read from the bottom, shrunk, turned, then moved up and aside in the frame of this one
    local on = gr.node('on' .. i)
    on:translate(1.3, 1.75, 0)
    on:rotate('z', -28)
    on:rotate('y', 36)
    on:scale(0.68, 0.68, 0.68)
    where:add_child(on)
    where = on
end
local floor = gr.cube('floor')
floor:set_material(gr.material({0.6, 0.6, 0.62}, {0, 0, 0}, 1))
floor:translate(-20, -2.62, -20)
floor:scale(40, 1, 40)
scene:add_child(floor)

gr.render(scene, 'dodeca.png', 320, 320, {1.8, 3.4, 13}, {0, -0.14, -1}, {0, 1, 0}, 40, {0.3, 0.3, 0.33},
    {gr.light({-8, 12, 10}, {0.7, 0.68, 0.6}, {1, 0, 0}), gr.light({10, 4, 8}, {0.25, 0.25, 0.32}, {1, 0, 0})},
    {background = {0.3, 0.34, 0.4}})
