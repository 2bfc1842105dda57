-- TITLE: Placed shapes
-- Spheres, boxes and a mesh without a hierarchy: the first scene of every course.
-- Author: gray project. Dialect: classic.

red = gr.material({0.8, 0.2, 0.15}, {0.5, 0.5, 0.5}, 25)
green = gr.material({0.3, 0.65, 0.3}, {0.4, 0.4, 0.4}, 20)
blue = gr.material({0.2, 0.3, 0.75}, {0.6, 0.6, 0.6}, 40)
sand = gr.material({0.8, 0.7, 0.5}, {0.1, 0.1, 0.1}, 5)

scene = gr.node('scene')

floor = gr.nh_box('floor', {-2000, -4000, -2500}, 4000)
floor:set_material(sand)
scene:add_child(floor)

s1 = gr.nh_sphere('s1', {0, 90, -300}, 90)
s1:set_material(red)
scene:add_child(s1)

s2 = gr.nh_sphere('s2', {160, 60, -180}, 60)
s2:set_material(blue)
scene:add_child(s2)

s3 = gr.nh_sphere('s3', {-150, 45, -150}, 45)
s3:set_material(green)
scene:add_child(s3)

b1 = gr.nh_box('b1', {-260, 0, -380}, 120)
b1:set_material(blue)
scene:add_child(b1)

-- a negative size extends in the other direction
b2 = gr.nh_box('b2', {80, 40, -60}, -40)
b2:set_material(red)
scene:add_child(b2)

white_light = gr.light({-300, 500, 200}, {0.8, 0.8, 0.75}, {1, 0, 0})
pink_light = gr.light({400, 200, 150}, {0.35, 0.25, 0.3}, {1, 0, 0})

gr.render(scene, 'nonhier.png', 384, 384, {0, 180, 520}, {0, -0.25, -1}, {0, 1, 0}, 45,
    {0.3, 0.3, 0.3}, {white_light, pink_light}, {background = {0.3, 0.34, 0.4}})
