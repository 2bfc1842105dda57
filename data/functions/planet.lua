-- TITLE: Functions: a planet
-- One function is the height of the ground: it displaces an icosahedron, and the colours depend on it. The clouds are a
-- shell whose opacity is a second function, and so is the air, as thick as the way of the view through it. The stars of
-- the sky are a third function.
-- Author: gray project

local function fbm(p, octaves)
    local sum, size = 0, 1
    for _ = 1, octaves do
        sum = sum + gr.noise(p / size) * size
        p, size = p + 7.3, size / 2
    end
    return sum
end

-- The height in a direction; land is above 0.
local function height(d)
    local warped = d * 1.6 + 0.35 * gr.vec(gr.noise(d * 2 + 3), gr.noise(d * 2 + 11), gr.noise(d * 2 + 19))
    local land = fbm(warped, 6) + 0.06
    local ridge = 1 - 2 * math.abs(gr.noise(d * 5 + 2)) - math.abs(gr.noise(d * 11 + 5))
    return land + 0.45 * gr.clamp(land, 0, 0.5) * gr.max(ridge, 0)
end

local g = (1 + math.sqrt(5)) / 2
local globe = gr.mesh {
    verts = {
        { -1, g, 0 }, { 1, g, 0 }, { -1, -g, 0 }, { 1, -g, 0 }, { 0, -1, g }, { 0, 1, g }, { 0, -1, -g }, { 0, 1, -g }, { g, 0, -1 }, { g, 0, 1 },
        { -g, 0, -1 }, { -g, 0, 1 },
    },
    faces = {
        { 0, 11, 5 }, { 0, 5, 1 }, { 0, 1, 7 }, { 0, 7, 10 }, { 0, 10, 11 }, { 1, 5, 9 }, { 5, 11, 4 }, { 11, 10, 2 }, { 10, 7, 6 }, { 7, 1, 8 },
        { 3, 9, 4 }, { 3, 4, 2 }, { 3, 2, 6 }, { 3, 6, 8 }, { 3, 8, 9 }, { 4, 9, 5 }, { 2, 4, 11 }, { 6, 2, 10 }, { 8, 6, 7 }, { 9, 8, 1 },
    },
}
globe:displace {
    f = function(p)
        local d = p:normalize()
        return d * (1 + 0.025 * gr.max(height(d), 0)) - p
    end,
    level = quick and 4 or 7, -- -D quick=true makes a draft
}

local function ground(p)
    local d = p:normalize()
    local h, cold = height(d), math.abs(d.y) + 0.10 * gr.noise(d * 7)
    local sea = gr.mix({ 0.02, 0.09, 0.22 }, { 0.07, 0.32, 0.44 }, gr.smoothstep(-0.25, 0, h))
    local green = gr.mix({ 0.47, 0.44, 0.24 }, { 0.14, 0.32, 0.10 }, gr.smoothstep(-0.2, 0.25, gr.noise(d * 3 + 4) + 0.9 * cold - 0.2))
    local land = gr.mix({ 0.72, 0.64, 0.44 }, green, gr.smoothstep(0.0, 0.05, h))
    land = gr.mix(land, { 0.42, 0.36, 0.31 }, gr.smoothstep(0.22, 0.42, h))
    land = gr.mix(land, { 0.95, 0.96, 0.98 }, gr.max(gr.smoothstep(0.45, 0.6, h), gr.smoothstep(0.78, 0.86, cold)))
    return gr.mix(gr.mix(sea, { 0.90, 0.94, 0.97 }, gr.smoothstep(0.86, 0.92, cold)), land, gr.step(0, h))
end
local function shine(p) return 0.45 * gr.step(height(p:normalize()), 0) * gr.vec(1, 1, 0.95) end
globe:set_material(gr.material { kd = ground, ks = shine, shininess = 35 })

-- Weather: fronts turn around lows, whose places are those of a slow noise. Towards the rim clouds hide each other, and the
-- fine ones are lost in the air.
local function clouds(p, s)
    local d = p:normalize()
    local low, _, id = gr.cells(d * 1.7 + 4)
    local turn = 2.6 * gr.smoothstep(0.55, 0.0, low) * (id - 0.4)
    local x, z = d.x * math.cos(turn) - d.z * math.sin(turn), d.x * math.sin(turn) + d.z * math.cos(turn)
    local q = gr.vec(x, d.y, z) + 0.16 * gr.vec(gr.noise(d * 4), gr.noise(d * 4 + 5), gr.noise(d * 4 + 9))
    local cover = fbm(q * 1.9 + 2, 3) + 0.30 * gr.turbulence(q * 9, 5) - 0.12
    return 0.95 * gr.smoothstep(0.02, 0.5, cover) * gr.smoothstep(0.0, 0.25, s.normal:dot(s.view))
end
local sky = gr.sphere { radius = 1.025, material = gr.material { kd = { 0.96, 0.97, 1 }, opacity = clouds } }

-- The air is a ball of radius r around the planet: the view has the distance b from the centre, and a way through the ball,
-- which ends on the ground or leaves it; above the ground the air is thinner by the height.
local r = 1.06
local function air(p, s)
    local c = gr.clamp(s.normal:dot(s.view), 0, 1)
    local b = r * (1 - c * c) ^ 0.5
    local way = r * c + gr.mix(-gr.max(1 - b * b, 0) ^ 0.5, r * c, gr.step(1, b))
    return 1 - math.exp(-1.5 * way * math.exp(-gr.max(b - 1, 0) / 0.014))
end
local blue = gr.sphere { radius = r, material = gr.material { kd = { 0.30, 0.55, 1.0 }, opacity = air } }

local function stars(d)
    local near, _, id = gr.cells(d * 45)
    local glow = gr.smoothstep(0.11, 0.0, near) * id ^ 4
    return gr.vec(0.004, 0.005, 0.010) + glow * gr.mix({ 1, 0.85, 0.7 }, { 0.75, 0.85, 1 }, id)
end

local scene = gr.node 'space'
scene:add_child(globe)
scene:add_child(sky)
scene:add_child(blue)
gr.render {
    node = scene, file = 'planet.png', width = 640, height = 480, eye = { 1.2, 0.85, 3.1 }, target = { 0.03, 0, 0 }, fov = 40, ambient = { 0.004, 0.005, 0.008 },
    background = stars, tone = 'filmic', exposure = 0.25, lights = { gr.directional_light { direction = { -1.0, -0.30, -0.12 }, colour = { 1.25, 1.18, 1.05 } } },
}
