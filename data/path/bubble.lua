-- Soap bubbles: the film is thin above and thick below, and currents stir it.
-- TITLE: Soap bubbles
-- OPTIONS: --spp 72

-- A wall of the index of air is its film alone; the thickness in micrometres is a function of the point.
local function soap(seed, thin, thick)
    return gr.openpbr_material{
        transmission_weight = 1,
        specular_roughness = 0,
        specular_ior = 1,
        geometry_thin_walled = true,
        thin_film_weight = 1,
        thin_film_ior = 1.33,
        thin_film_thickness = function(p)
            local q = gr.vec(1.6 * p.x + seed, 2.6 * p.y, 1.6 * p.z)
            local height = 0.5 - 0.5 * p.y + 0.11 * gr.turbulence(q + gr.vec(0, 0.7 * gr.noise(q * 1.7), 0), 4)
            return thin + (thick - thin) * gr.clamp(height, 0, 1.1)
        end,
    }
end

local scene = gr.node('bubbles')
local function bubble(x, y, z, radius, seed, thin, thick)
    local ball = gr.sphere(soap(seed, thin, thick))
    ball:scale(radius, radius, radius)
    ball:translate(x, y, z)
    scene:add_child(ball)
end
bubble(0, 0, 0, 1, 0, 0.12, 0.75)
bubble(1.55, 0.75, -0.8, 0.5, 5, 0.1, 0.6)
bubble(-1.35, -0.8, 0.3, 0.3, 9, 0.1, 0.5)

gr.render{
    node = scene,
    file = 'bubble.png',
    width = 360,
    height = 270,
    integrator = 'path',
    denoise = true,
    eye = {0.15, 0.1, 6},
    target = {0.15, 0, 0},
    fov = 30,
    -- Behind the viewer is a bright room with a window; the bubbles float before the dark.
    background = function(d)
        local window = gr.step(0.1, 0.4 - math.abs(d.x - 0.35)) * gr.step(0.1, 0.4 - math.abs(d.y - 0.35)) * gr.step(0.3, d.z)
        local bar = gr.step(0.012, math.abs(d.x - 0.35)) * gr.step(0.012, math.abs(d.y - 0.35))
        return gr.vec(0.012, 0.016, 0.022) + gr.vec(0.9, 0.92, 1) * (gr.smoothstep(-0.35, 0.9, d.z) + 0.7 * gr.smoothstep(0.1, 0.9, math.abs(d.y))) + gr.vec(6, 6.2, 6.6) * (window * bar)
    end,
}
