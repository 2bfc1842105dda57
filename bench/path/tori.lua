-- CSG for bench/device.sh: tori with a bite, of gold and of lacquer, in a white box with a red and a green wall.
local white, red, green = gr.material{kd = {.73, .73, .73}}, gr.material{kd = {.62, .06, .05}}, gr.material{kd = {.13, .46, .09}}
local scene = gr.node 'box'
for _, wall in ipairs{{white, {-3, 0, 3}, {6, 0, 0}, {0, 0, -6}}, {white, {-3, 0, -3}, {6, 0, 0}, {0, 6, 0}}, {white, {-3, 6, -3}, {6, 0, 0}, {0, 0, 6}},
                      {red, {-3, 0, 3}, {0, 0, -6}, {0, 6, 0}}, {green, {3, 0, -3}, {0, 0, 6}, {0, 6, 0}}} do
    scene:add_child(gr.rectangle{material = wall[1], corner = wall[2], along = wall[3], up = wall[4]})
end
scene:add_child(gr.rectangle{material = gr.material{kd = {0, 0, 0}, emission = {18, 16, 12}}, corner = {-.8, 5.99, -.8}, along = {1.6, 0, 0}, up = {0, 0, 1.6}})
local gold = gr.metal_material{metal = 'gold', roughness = .25}
local lacquer = gr.openpbr_material{base_color = {.45, .012, .02}, specular_weight = .3, coat_weight = 1, coat_ior = 1.55}
for i = 0, 5 do
    local ring = gr.torus{major = .8, minor = .3, material = i % 2 == 0 and gold or lacquer}
    scene:add_child(gr.difference{ring, gr.sphere{radius = .55, centre = {.8, 0, 0}, material = red}}
        :rotate('x', 30 * i):translate(1.8 * (i % 3) - 1.8, 1 + 2.2 * (i // 3), -.6))
end
scene:add_child(gr.sphere{centre = {-1.5, .7, 1.6}, radius = .7, material = gr.openpbr_material{transmission_weight = 1, specular_roughness = 0}})
scene:add_child(gr.sphere{centre = {1.6, .6, 1.5}, radius = .6, material = gold})
gr.render{node = scene, file = 'tori.png', width = 512, height = 512, integrator = 'path', eye = {0, 3, 11}, target = {0, 2.8, 0}, fov = 40, background = {0, 0, 0}}
