-- Twin of primitives.pov: the same solids, lamps and camera with z reversed; materials as similar as both languages
-- allow. Rendered with limits of 8 and 8 and --cutoff 0.0039: POV-Ray counts to 8 and drops rays of less than 1/255
-- weight (adc_bailout).
local ambient = 0.08

-- diffuse * colour, a highlight, and a mirror with a separate weight: ks filters both, so reflect is relative to it.
local function finish(colour, diffuse, phong, size, reflection)
    local kd = {colour[1] * diffuse, colour[2] * diffuse, colour[3] * diffuse}
    return gr.rr_material(kd, {phong, phong, phong}, size, reflection / phong, 0, 1)
end

local scene = gr.node('scene')
local floor_look = gr.td_cube_material{material = gr.rr_material({0.5, 0.5, 0.5}, {0.15, 0.15, 0.15}, 1000000, 1, 0, 1), png = 'checker28.png', filter = 'nearest'}
local floor = gr.nh_box(floor_look, {-14, -28, -14}, 28)
scene:add_child(floor)

local glass = gr.rr_material({0.01, 0.01, 0.01}, {0.9, 0.92, 0.94}, 80, 0.1, 0.9, 1.5)
for i = 0, 24 do
    local x, z = i % 5 - 2, i // 5 - 2
    local look = i % 3 == 0 and finish({0.8, 0.2 + 0.1 * x, 0.2}, 0.7, 0.6, 40, 0.3)
        or i % 3 == 1 and finish({0.2, 0.6, 0.3 + 0.1 * z}, 0.7, 0.6, 40, 0.05) or glass
    scene:add_child(gr.nh_sphere(look, {1.6 * x, 0.6, -1.6 * z}, 0.6))
end
for i = 0, 11 do
    local post = gr.geometry('post', gr.cube(finish({0.7, 0.65, 0.2 + 0.06 * i}, 0.7, 0.6, 40, 0.2)))
    post:translate(-0.5, 0, -0.5)
    post:scale(0.7, 0.8 + 0.15 * (i % 4), 0.7)
    post:rotate('y', 23 * i)
    post:translate(5.6 * math.cos(i * math.pi / 6), 0, -5.6 * math.sin(i * math.pi / 6))
    scene:add_child(post)
end

local lamps = {
    gr.light({8, 12, 9}, {0.90, 0.90, 0.85}, {1, 0, 0}),
    gr.light({-9, 7, 6}, {0.25, 0.28, 0.35}, {1, 0, 0}),
}
local vertical = math.deg(2 * math.atan(math.tan(math.rad(25)) * 3 / 4))
gr.render{node = scene, file = 'primitives.png', width = 640, height = 480, eye = {0, 4.5, 11}, view = {0, -3.6, -11},
          up = {0, 1, 0}, fov = vertical, ambient = {ambient / 0.7, ambient / 0.7, ambient / 0.7}, lights = lamps,
          background = {0.25, 0.35, 0.55}}
