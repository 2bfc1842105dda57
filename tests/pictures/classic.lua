-- TITLE: The classic dialect
-- OPTIONS: --view target --pixel-sample corner --ambient plain --specular blinn
-- Covers scripts of the course: readobj and the old transform order that it implies, joints, shapes by name,
-- positional arguments, meshes by tables, node:set_material, node:set_texture and node:set_bump on scaled shapes, and the
-- options for views by target, samples at corners, plain ambient light and Blinn highlights.
-- Author: gray project. Dialect: classic, OLD order: the last call acts first on the object.

require('readobj')

red = gr.material({0.8, 0.2, 0.15}, {0.5, 0.5, 0.5}, 25)
green = gr.material({0.3, 0.6, 0.25}, {0.2, 0.2, 0.2}, 10)
white = gr.material({0.85, 0.85, 0.8}, {0.6, 0.6, 0.6}, 60)
hidden = gr.material({0, 0, 0}, {0, 0, 0}, 1)

scene = gr.node('scene')
scene:rotate('Y', -15)

hill = gr.sphere('hill')
hill:set_material(green)
hill:translate(0, -21.5, 0)
hill:scale(20, 20, 20)
scene:add_child(hill)

cow_verts, cow_faces = readobj('../../data/classic/cow.obj')
cow = gr.mesh('cow', cow_verts, cow_faces)
cow:set_material(white)
herd = gr.node('herd')
herd:add_child(cow)
for k = 0, 2 do
    place = gr.node('place' .. k)
    place:translate(3 * k - 3, -0.8, -2 * k)
    place:rotate('y', 70 * k)
    place:scale(0.25, 0.25, 0.25)
    place:add_child(herd)
    scene:add_child(place)
end

globe = gr.nh_sphere('globe', {-2, 2.2, 0}, 0.8)
globe:set_material(white)
globe:set_texture('../../textures/earth.png')
scene:add_child(globe)

crate = gr.nh_box('crate', {0, 0, 0}, 1)
crate:set_material(red)
crate:set_texture('../../textures/label.png')
crate:set_bump('../../textures/bricks_height.png')
crate:translate(0.2, 1.8, 0)
crate:rotate('x', 20)
crate:rotate('y', 30)
crate:scale(1.2, 0.8, 1)
scene:add_child(crate)

cube = gr.cube('cube')
cube:set_material(white)
cube:set_bump('../../textures/weave_normal.png')
cube:translate(2, 1.5, -1)
cube:rotate('z', 30)
scene:add_child(cube)

shoulder = gr.joint('shoulder', {-45, 30, 45}, {-20, 10, 20})
shoulder:translate(-0.3, 0, 2)
scene:add_child(shoulder)
arm = gr.sphere('arm')
arm:set_material(red)
arm:scale(1, 0.2, 0.2)
arm:translate(0.8, 0, 0)
shoulder:add_child(arm)
elbow = gr.joint('elbow', {0, 60, 90}, {0, 0, 0})
elbow:translate(1.5, 0, 0)
shoulder:add_child(elbow)
hand = gr.sphere('hand')
hand:set_material(green)
hand:scale(0.3, 0.5, 0.3)
elbow:add_child(hand)

pyramid = gr.mesh('pyramid', {{0, 1, 0}, {1, 0, 1}, {1, 0, -1}, {-1, 0, -1}, {-1, 0, 1}}, {{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0,
    4, 1}, {1, 4, 3, 2}})
pyramid:set_material(red)
pyramid:translate(3, -0.9, 2)
scene:add_child(pyramid)

key = gr.light({-6, 8, 10}, {0.6, 0.6, 0.55}, {1, 0, 0})
fill = gr.light({8, 4, 6}, {0.9, 0.9, 1}, {1, 0.1, 0.01})
gr.render(scene, 'classic-1.png', 96, 72, {0, 2.5, 10}, {0, 1, -1}, {0, 1, 0}, 40, {0.1, 0.1, 0.12}, {key, fill})
gr.render(cow, 'classic-2.png', 96, 72, {6, 5, 12}, {0, 0, -0.5}, {0.2, 1, 0}, 30, {0.2, 0.1, 0.1}, {key})
