-- A beam of white light through a slit, and the spectrum into which a prism of dense flint divides it.
-- TITLE: A prism and its spectrum
-- OPTIONS: --spp 24 --caustics 2000000

local flint = gr.openpbr_material{transmission_weight = 1, specular_roughness = 0, glass = 'N-SF11'}
local paper = gr.openpbr_material{base_color = {0.82, 0.82, 0.8}, specular_weight = 0}
local black = gr.openpbr_material{base_color = {0.025, 0.025, 0.03}, specular_roughness = 0.6}

local scene = gr.node('prism and its spectrum')
scene:add_child(gr.cube{name = 'table', material = paper, corner = {-30, -0.5, -30}, size = {60, 0.5, 60}})

-- Light comes from the left, a little from above: the sheet behind the slit touches the table on its whole way.
local slope, slit, high = 0.17, 0.035, 3
scene:add_child(gr.cube{name = 'screen', material = black, corner = {-3.1, 0, slit}, size = {0.1, high, 12}})
scene:add_child(gr.cube{name = 'screen', material = black, corner = {-3.1, 0, -12 - slit}, size = {0.1, high, 12 - slit}})

-- Three sides; the light meets it as the angle of the least deviation wants.
local height, side, turn = 1.3, 1.7, math.rad(147)
local corners, faces = {}, {{2, 1, 0}, {3, 4, 5}, {1, 4, 3, 0}, {2, 5, 4, 1}, {0, 3, 5, 2}}
for k = 0, 5 do
    local angle, radius = turn + math.rad(120) * (k % 3), side / math.sqrt(3)
    corners[k + 1] = {radius * math.sin(angle), k < 3 and 0.001 or height, radius * math.cos(angle)}
end
local prism = gr.mesh('prism', corners, faces)
prism:set_material(flint)
prism:translate(0.2, 0, 0.44)
scene:add_child(prism)

gr.render{
    node = scene,
    file = 'prism.png',
    width = 360,
    height = 270,
    integrator = 'path',
    denoise = true,
    eye = {-0.4, 7, 9},
    target = {0.85, 0.2, 1.75},
    fov = 33,
    background = {0.055, 0.06, 0.08},
    lights = {gr.directional_light{direction = {1, -slope, 0}, colour = {9, 9, 9}}},
}
