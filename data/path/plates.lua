-- TITLE: Lamps in plates
-- OPTIONS: --spp 48 --fxaa
-- Three plates of metal, from polished to rough, show four lamps, from small and bright to large and dim, after the
-- picture by which Veach and Guibas compared sampling methods ("Optimally Combining Sampling Techniques for Monte Carlo
-- Rendering", 1995). The lamps have the same power: small ones are found by sampling lights, large ones in polished
-- plates by sampling the BSDF. Multiple importance sampling combines both methods.
local scene = gr.node('scene')
local wall = gr.material { kd = { .34, .34, .36 }, two_sided = true }

scene:add_child(gr.rectangle { material = wall, corner = { -14, -4, 8 }, along = { 28, 0, 0 }, up = { 0, 0, -14 } })
scene:add_child(gr.rectangle { material = wall, corner = { -14, -4, -6 }, along = { 28, 0, 0 }, up = { 0, 18, 0 } })

-- Each plate is tilted so that its centre reflects the middle of the row of lamps.
local eye, lamps = { 0, 2.16, 13.5 }, { 0, 4.6, -3 }
local function unit(v)
    local length = math.sqrt(v[1] ^ 2 + v[2] ^ 2 + v[3] ^ 2)
    return { v[1] / length, v[2] / length, v[3] / length }
end
local function towards(from, to) return unit { to[1] - from[1], to[2] - from[2], to[3] - from[3] } end

for i, roughness in ipairs { .08, .2, .32 } do
    local middle = { 0, 1.55 - .85 * i, -3 + 2.2 * i }
    local a, b = towards(middle, eye), towards(middle, lamps)
    local normal = unit { 0, a[2] + b[2], a[3] + b[3] }
    local plate = gr.box { min = { -4.2, -.06, -.85 }, max = { 4.2, 0, .85 },
        material = gr.material { kd = { .02, .02, .022 }, ks = { .86, .87, .9 }, reflect = 1, roughness = roughness } }
    plate:rotate('x', math.deg(math.atan(normal[3], normal[2])))
    plate:translate(middle[1], middle[2], middle[3])
    scene:add_child(plate)
end

local colours = { { 1, .55, .35 }, { 1, .9, .5 }, { .5, .95, .6 }, { .5, .65, 1 } }
for i, radius in ipairs { .06, .2, .5, .95 } do
    local strength = 1.5 / radius ^ 2
    local c = colours[i]
    scene:add_child(gr.sphere { centre = { -4.6 + 3 * (i - 1), lamps[2], lamps[3] }, radius = radius,
        material = gr.material { kd = { 0, 0, 0 }, emission = { c[1] * strength, c[2] * strength, c[3] * strength } } })
end

gr.render {
    node = scene, file = 'plates.png', width = 480, height = 360, integrator = 'path', denoise = true,
    eye = eye, target = { 0, .9, 0 }, fov = 38, background = { 0, 0, 0 }, tone = 'filmic',
    filter = 'gaussian',
}
