-- One row of coefficients: absorption, scattering, albedo with a distance of 0.3 and of 1, emission with absorption. One row of directions
-- and heat: g 0.8 and -0.6, phase 'rayleigh', temperature 1,700, and a function of temperatures. One row of densities: 0.3, a function, the
-- same with a bound, a grid, and a box that ends at the top.
local scene = gr.node('media')
local floor = gr.openpbr_material{base_color = {0.25, 0.25, 0.27}, specular_weight = 0}
scene:add_child(gr.cube{material = floor, corner = {-20, -0.5, -12}, size = {40, 0.5, 28}})
local milk, box = {1, 1.5, 2}, {-1, -1, -1}
local function waves(p) return 2 * gr.max(0.0, math.sin(7 * p.y + 2 * p.x)) end
local function dense(p) return 3 * gr.max(0.0, 0.9 - gr.length(p * gr.vec(1.3, 0.95, 1.3) + gr.vec(0, 0.1, 0))) end
local function flame(p) return 2300 * gr.max(0.0, 1 - 0.55 * gr.length(p * gr.vec(2, 0.8, 2) + gr.vec(0, 0.3, 0))) end
local grid = {}
for i = 0, 26 do grid[i + 1] = i % 2 == 0 and 2 or 0 end
local rows = {
    {{absorption = {0.3, 1, 2}}, {scattering = milk}, {albedo = {0.99, 0.9, 0.6}, distance = 0.3}, {albedo = {0.99, 0.9, 0.6}, distance = 1},
        {absorption = {1, 1, 1}, emission = {0.1, 0.3, 0.6}}},
    {{scattering = milk, g = 0.8}, {scattering = milk, g = -0.6}, {scattering = milk, phase = 'rayleigh'},
        {absorption = {2, 2, 2}, temperature = 1700},
        {absorption = {2, 2, 2}, density = dense, temperature = flame, corner = box, size = 2}},
    {{scattering = milk, density = 0.3}, {scattering = milk, density = waves, corner = box, size = 2},
        {scattering = milk, density = waves, bound = 0.5, corner = box, size = 2}, {scattering = milk, density = grid, cells = {3, 3, 3}},
        {scattering = milk, top = 0.2}},
}
for r, row in ipairs(rows) do
    for c, fields in ipairs(row) do
        local ball = gr.sphere{medium = gr.medium(fields)}
        ball:translate((c - 3) * 2.5, 1.02, (r - 2) * 3.2)
        scene:add_child(ball)
    end
end
gr.render{
    node = scene, file = 'media.png', width = 500, height = 300, integrator = 'path', denoise = true, spp = 32, max_depth = 40,
    eye = {0, 11, 14.5}, target = {0, 0.2, 0.2}, fov = 27, background = {0.2, 0.21, 0.23},
    lights = {
        gr.sky_light{sky = {0.2, 0.21, 0.23}},
        gr.area_light{colour = {1, 1, 1}, emission = {22, 20, 18}, corner = {-4, 5, -9}, v1 = {8, 0, 0}, v2 = {0, 2, 2}, visible = true},
    },
    tone = 'filmic', exposure = 0.3, filter = 'gaussian', clamp = 8,
}
