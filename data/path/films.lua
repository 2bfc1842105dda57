-- Films on black lacquer, .1 to .7 micrometres thick, and of oxide on titanium, .04 to .28 micrometres thick.
-- TITLE: Thin films
-- OPTIONS: --spp 16

local scene = gr.node('films')
local function ball(material, column, row, radius)
    scene:add_child(gr.sphere{material = material, centre = {column, row, 0}, radius = radius})
end
for k = 1, 7 do
    local film = {thin_film_weight = 1, thin_film_thickness = k / 10, thin_film_ior = 1.4}
    local lacquer = {base_color = {0.01, 0.01, 0.01}, specular_roughness = 0.1, specular_ior = 1.8}
    local metal = {base_color = {0.62, 0.58, 0.54}, base_metalness = 1, specular_roughness = 0.2}
    for name, value in pairs(film) do lacquer[name], metal[name] = value, value end
    metal.thin_film_ior = 2.3
    metal.thin_film_thickness = k / 25
    ball(gr.openpbr_material(lacquer), 1.1 * (k - 4), 1.1, 0.48)
    ball(gr.openpbr_material(metal), 1.1 * (k - 4), 0, 0.48)
end

gr.render{
    node = scene,
    file = 'films.png',
    width = 360,
    height = 112,
    integrator = 'path',
    denoise = true,
    eye = {0, 0.55, 14},
    target = {0, 0.55, 0},
    fov = 10,
    background = function(d) return gr.vec(0.95, 0.97, 1) * (0.08 + gr.smoothstep(-0.3, 0.9, d.z) + 0.8 * gr.smoothstep(0.2, 1, d.y)) end,
}
