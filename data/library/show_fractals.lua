-- TITLE: Library: sponge, pyramid and flake
-- Menger's sponge of 8,000 cubes with a corner cut off along its diagonal, Sierpinski's pyramid of 15,625, a flake of
-- 7,381 balls. All are instances except the cut sponge, which is a closed mesh in a CSG solid.
-- Author: gray project

local studio = require 'studio'
local fractals = require 'fractals'

local scene = gr.node 'fractals'
local function put(node, x, y, z, size, turn) studio.place(scene, node, x, y, z, turn, size) end

-- The plane x + y + z = 0 cuts the sponge in stars.
local clay, cut = studio.matt { 0.75, 0.40, 0.24 }, studio.matt { 0.93, 0.86, 0.72 }
local sponge = gr.difference('cut sponge', gr.mesh(clay, fractals.menger_mesh(quick and 2 or 3)),
    gr.plane { normal = { -1, -1, -1 }, distance = -0.001, material = cut })
put(sponge, -0.3, 1.5, -1.2, 1.5, -45)

local balls = {}
for k, c in ipairs { { 0.55, 0.06, 0.09 }, { 0.62, 0.22, 0.07 }, { 0.70, 0.46, 0.10 }, { 0.72, 0.66, 0.36 } } do
    balls[k] = studio.glaze(c)
end
put(fractals.sphere_flake(4, balls), 3.9, 1.0, 0.6, 1.0, 12)

put(fractals.sierpinski(6, studio.matt { 0.30, 0.52, 0.62 }, 'pyramid'), -4.0, 0, 0.3, 1.75, 25)

studio.render { node = scene, file = 'show_fractals.png', eye = { 0.6, 5.2, 15 }, target = { 0.05, 1.4, -0.3 }, fov = 25, floor = { 0.09, 0.085, 0.08 },
    key = { 8, 11, -3 }, lamp = 3, light = { 2.2, 2.0, 1.7 }, sky = { 0.14, 0.15, 0.18 } }
