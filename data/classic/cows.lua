-- TITLE: Macho cows
-- A herd on a hill, in the style of the old assignments: readobj returns vertices and faces together.
-- Author: gray project. Dialect: classic, OLD order: the last call acts first on the object (as gray detects from readobj).

gr.transform_order('old')
require('readobj')

brown = gr.material({0.5, 0.32, 0.2}, {0.2, 0.2, 0.2}, 12)
black = gr.material({0.14, 0.13, 0.13}, {0.3, 0.3, 0.3}, 20)
white = gr.material({0.85, 0.83, 0.78}, {0.1, 0.1, 0.1}, 8)
grass = gr.material({0.3, 0.52, 0.18}, {0, 0, 0}, 1)
stone = gr.material({0.6, 0.6, 0.58}, {0.1, 0.1, 0.1}, 5)

scene = gr.node('scene')

hill = gr.sphere('hill')
hill:set_material(grass)
hill:translate(0, -60, 0)
hill:scale(60, 60, 60)
scene:add_child(hill)

-- one cow, many nodes
cow = gr.mesh('cow', readobj('cow.obj'))
cow:set_material(brown)
calf = gr.mesh('calf', readobj('cow.obj'))
calf:set_material(white)
bull = gr.mesh('bull', readobj('cow.obj'))
bull:set_material(black)

-- on the hill the ground falls by (x*x + z*z)/120
function put(what, x, z, turn, size)
    local at = gr.node('at')
    at:translate(x, -(x * x + z * z) / 120 - 0.03, z)
    at:rotate('Y', turn)
    at:scale(size, size, size)
    at:add_child(what)
    scene:add_child(at)
end
put(bull, 0, 1, -60, 1.3)
put(cow, -4.4, -1, 20, 1)
put(cow, 4.2, -2, 200, 1)
put(cow, -1.5, -6, 150, 1)
put(cow, 7, -8, 30, 1)
put(cow, -8, -7, -30, 1)
put(calf, -2.6, 3.2, 35, 0.55)
put(calf, 3.2, 2.6, 110, 0.6)

-- a pedestal, so that the bull stands out
rock = gr.cube('rock')
rock:set_material(stone)
rock:translate(-2.2, -0.6, -0.6)
rock:rotate('Y', 10)
rock:scale(4.4, 0.63, 3.2)
rock:translate(0, 0, 0)
scene:add_child(rock)

gr.render(scene, 'cows.png', 480, 320, {0, 4.2, 17}, {0, -0.18, -1}, {0, 1, 0}, 31, {0.35, 0.35, 0.38},
    {gr.light({-12, 18, 14}, {0.75, 0.72, 0.62}, {1, 0, 0}), gr.light({15, 5, 10}, {0.15, 0.15, 0.2}, {1, 0, 0})},
    {background = {0.55, 0.68, 0.85}})
