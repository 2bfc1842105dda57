-- A small picture with everything that could depend on the division of work: a photon map, soft lights, glass, mirrors,
-- a combined solid, a mesh with smooth normals, noise, an image, fog, a lens, a moving ball and marked pixels. For
-- tools/one_hash.sh.
local white = gr.material({0.8, 0.8, 0.8}, {0, 0, 0}, 1)
local glass = gr.rr_material({0, 0, 0}, {1, 1, 1}, 100, 0.1, 0.9, 1.5)
local mirror = gr.rr_material({0.1, 0.1, 0.1}, {0.8, 0.8, 0.8}, 50, 0.8, 0, 1)
local root = gr.node('root')
local later = gr.node('later')
later:translate(0.2, 0.1, 0)
local function add(node) root:add_child(node) return node end
add(gr.rectangle{material = gr.marble_pnd_material{material = white, f = 3, multiplier = 2, vein_frequency = 4, mix = {0.2, 0.1, 0.1}},
    corner = {-6, -1, 6}, along = {12, 0, 0}, up = {0, 0, -12}})
add(gr.sphere{material = glass, centre = {-0.9, -0.2, 0.8}, radius = 0.8})
add(gr.sphere{material = mirror, centre = {1.1, -0.3, 0.2}, radius = 0.7}):moves_to(later)
add(gr.csg_difference{a = gr.cube{material = gr.material({0.9, 0.4, 0.2}, {0.3, 0.3, 0.3}, 20), corner = {-0.6, -1, -2}},
    b = gr.sphere{material = white, centre = {0, -0.2, -1.2}, radius = 0.6}})
add(gr.torus{material = gr.material({0.2, 0.5, 0.9}, {0.5, 0.5, 0.5}, 30), major = 0.8, minor = 0.2}):translate(2, 0.6, -2)
local verts, faces = {}, {}
for i = 0, 12 do
    for j = 0, 12 do
        local x, z = i / 6 - 1, j / 6 - 1
        verts[#verts + 1] = {x, math.sin(3 * x) * math.cos(2.5 * z) / 3, z}
        if i < 12 and j < 12 then
            local k = i * 13 + j
            faces[#faces + 1] = {k, k + 1, k + 14, k + 13}
        end
    end
end
add(gr.mesh{material = white, verts = verts, faces = faces, smooth = 60}):translate(-2.4, 0.2, -2)
local lights = {gr.area_light({2, 5, 3}, {1, 0, 0}, {0, 0, 1}, {0.7, 0.7, 0.6}),
                gr.light({-5, 4, 6}, {0.3, 0.3, 0.4}, {1, 0, 0})}
gr.render{node = root, file = 'one_hash.png', width = 250, height = 190, eye = {0, 1, 7}, view = {0, -0.15, -1},
    up = {0, 1, 0}, fov = 40, ambient = {0.15, 0.15, 0.2}, lights = lights, caustics = {photons = 20000},
    aperture = 0.03, focus = 6.5, samples = 2, area_samples = 2, fog = gr.uniform_fog{density = 0.02, colour = {0.6, 0.7, 0.8}}}
