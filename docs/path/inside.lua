-- One row of wax: subsurface_radius 0, 0.1, 0.3, 1, and 0.3 with anisotropy 0.8. One row of glass: transmission_scatter
-- black, {.1, .1, .1}, {1, 1, 1}, {.5, .8, 1.2}, and that with anisotropy 0.8.
local scene = gr.node('parameters')
local floor = gr.openpbr_material{base_color = {0.25, 0.25, 0.27}, specular_weight = 0}
scene:add_child(gr.cube{material = floor, corner = {-20, -0.5, -8}, size = {40, 0.5, 20}})
local function wax(radius, g)
    return gr.openpbr_material{subsurface_weight = 1, subsurface_color = {0.9, 0.6, 0.4}, subsurface_radius = radius,
        subsurface_scatter_anisotropy = g, specular_roughness = 0.3}
end
local function glass(scatter, g)
    return gr.openpbr_material{transmission_weight = 1, specular_roughness = 0, transmission_depth = 1, transmission_color = {0.75, 0.6, 0.4},
        transmission_scatter = scatter, transmission_scatter_anisotropy = g}
end
local rows = {
    {wax(0, 0), wax(0.1, 0), wax(0.3, 0), wax(1, 0), wax(0.3, 0.8)},
    {glass({0, 0, 0}, 0), glass({0.1, 0.1, 0.1}, 0), glass({1, 1, 1}, 0), glass({0.5, 0.8, 1.2}, 0), glass({0.5, 0.8, 1.2}, 0.8)},
}
for r, row in ipairs(rows) do
    for c, material in ipairs(row) do
        local ring = gr.torus{material = material, major = 0.75, minor = 0.3}
        ring:rotate('x', 65)
        ring:rotate('y', 25)
        ring:translate((c - 3) * 2.5, 0.98, (r - 1.5) * 4.4)
        scene:add_child(ring)
    end
end
gr.render{
    node = scene, file = 'inside.png', width = 600, height = 270, integrator = 'path', denoise = true, spp = 64, max_depth = 200,
    eye = {0, 8.5, 13.5}, target = {0, 0.35, 0.1}, fov = 24, background = {0.2, 0.21, 0.23},
    lights = {
        gr.sky_light{sky = {0.2, 0.21, 0.23}},
        gr.area_light{colour = {1, 1, 1}, emission = {22, 20, 18}, corner = {-4, 5, -9}, v1 = {8, 0, 0}, v2 = {0, 2, 2}, visible = true},
    },
    tone = 'filmic', exposure = 0.3, filter = 'gaussian', clamp = 8,
}
