-- Layered or classic materials (-D classic=true): a floor, two balls and a box. See openpbr.sh.
local function material(colour, roughness)
    if classic then return gr.material{kd = colour, ks = {0.3, 0.3, 0.3}, shininess = 40} end
    return gr.openpbr_material{base_color = colour, specular_roughness = roughness}
end
local scene = gr.node('scene')
scene:add_child(gr.plane{material = material({0.7, 0.7, 0.68}, 0.4), normal = {0, 1, 0}, distance = -1})
scene:add_child(gr.nh_sphere(material({0.8, 0.2, 0.1}, 0.2), {-1.1, 0, 0}, 1))
scene:add_child(gr.nh_sphere(material({0.9, 0.7, 0.3}, 0.35), {1.1, 0, 0}, 1))
scene:add_child(gr.nh_box(material({0.2, 0.4, 0.8}, 0.3), {-0.5, -1, 1}, 0.8))
gr.render{
    node = scene, file = 'openpbr.png', width = 320, height = 180, eye = {0, 1.5, 6}, target = {0, -0.2, 0}, fov = 35,
    background = {0.5, 0.6, 0.8},
    lights = {
        gr.area_light{corner = {-3, 5, 1}, v1 = {2, 0, 0}, v2 = {0, 0, 2}, colour = {1, 1, 1}},
        gr.light({4, 3, 4}, {0.4, 0.4, 0.4}, {1, 0, 0}),
    },
}
