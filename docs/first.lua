-- TITLE: Three balls on marble
local gold = gr.material({0.8, 0.5, 0.1}, {0.7, 0.6, 0.4}, 40)
local glass = gr.difresnel_material(gr.rr_material({0, 0, 0}, {1, 1, 1}, 150, 1, 1, 1.5))
local mirror = gr.rr_material({0.05, 0.05, 0.1}, {0.9, 0.9, 1}, 150, 0.8, 0, 1)
local stone = gr.rr_material({0.9, 0.9, 0.85}, {0.5, 0.5, 0.5}, 80, 0.3, 0, 1)
local marble = gr.marble_pnd_material(stone, 0.7, 8, 1, 1, {0.35, 0.3, 0.3})

local scene = gr.node('scene')
for i, material in ipairs{gold, glass, mirror} do
    scene:add_child(gr.nh_sphere(material, {2.1 * i - 4.2, 0, -(i - 2)^2}, 1))
end
scene:add_child(gr.nh_box(marble, {-20, -41, -25}, 40))

local lamp = gr.area_light({-5, 7, 3}, {2, 0, 0}, {0, 0, 2}, {0.9, 0.9, 0.9}, {1, 0, 0})
gr.render{node = scene, file = 'first.png', width = 480, height = 320, eye = {0, 1.2, 8}, view = {0, -0.18, -1}, fov = 32,
          ambient = {0.25, 0.25, 0.25}, lights = {lamp}}
