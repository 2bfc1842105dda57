-- TITLE: A small hierarchy
-- Arches and spheres under nodes that turn and scale them together; the mesh comes from a file.
-- Author: gray project. Dialect: classic, calls act in the order they are written (detected from the mesh file name).

gold = gr.material({0.85, 0.65, 0.2}, {0.3, 0.3, 0.2}, 25)
grass = gr.material({0.15, 0.5, 0.2}, {0.0, 0.0, 0.0}, 0)
blue = gr.material({0.35, 0.45, 0.85}, {0.5, 0.5, 0.5}, 40)

scene = gr.node('scene')
scene:rotate('x', 18)
scene:translate(0, -1.2, -8)

plane = gr.cube('ground')
plane:set_material(grass)
plane:translate(-0.5, -1, -0.5)
plane:scale(30, 0.5, 30)
scene:add_child(plane)

gate = gr.node('gate')
arch = gr.mesh('arch', 'arch.obj')
arch:set_material(gold)
gate:add_child(arch)
top = gr.sphere('top')
top:set_material(blue)
top:scale(0.25, 0.25, 0.25)
top:translate(0, 2.4, 0)
arch:add_child(top)

for i = 0, 5 do
    local at = gr.node('at' .. i)
    at:scale(0.8, 0.8, 0.8)
    at:translate(0, 0, 3)
    at:rotate('y', 60 * i + 15)
    at:add_child(gate)
    scene:add_child(at)
end

middle = gr.sphere('middle')
middle:set_material(blue)
middle:translate(0, 1, 0)
scene:add_child(middle)
-- calls after add_child still count
middle:scale(1, 0.7, 1)

gr.render(scene, 'hier.png', 384, 288, {0, 0, 0}, {0, 0, -1}, {0, 1, 0}, 50, {0.35, 0.35, 0.4},
    {gr.light({6, 9, 2}, {0.8, 0.8, 0.7}, {1, 0, 0}), gr.light({-8, 3, 0}, {0.2, 0.2, 0.35}, {1, 0, 0})},
    {background = {0.55, 0.68, 0.85}})
