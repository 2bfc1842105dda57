-- Twin of implicit.pov: one implicit solid of ten, -D NAME=..., on a floor under one light with shadows.
local abs, exp, max, min, sin, cos, sqrt = math.abs, math.exp, math.max, math.min, math.sin, math.cos, math.sqrt

local golden = (1 + sqrt(5)) / 2
local balls = {{0, 0, 0}, {0.5, 0.3, 0.1}, {-0.4, 0.4, 0.3}, {0.1, -0.5, 0.3}, {-0.3, -0.2, -0.5}}

local function smooth_min(a, b, width)
    local h = max(width - abs(a - b), 0.0) / width
    return min(a, b) - h * h * width / 4
end

local functions = {
    bumps = function(p) return sqrt(p.x * p.x + p.y * p.y + p.z * p.z) - 0.8 + 0.1 * sin(10 * p.x) * sin(10 * p.y) * sin(10 * p.z) end,
    gyroid = function(p)
        local x, y, z = 8 * p.x, 8 * p.y, 8 * p.z
        return sin(x) * cos(y) + sin(y) * cos(z) + sin(z) * cos(x)
    end,
    wall = function(p)
        local x, y, z = 6 * p.x, 6 * p.y, 6 * p.z
        return abs(sin(x) * cos(y) + sin(y) * cos(z) + sin(z) * cos(x)) - 0.25
    end,
    barth = function(p)
        local x, y, z = 1.5 * p.x, 1.5 * p.y, 1.5 * p.z
        local a, b, c, g = x * x, y * y, z * z, golden * golden
        local sphere = a + b + c - 1
        return 4 * (g * a - b) * (g * b - c) * (g * c - a) - (1 + 2 * golden) * sphere * sphere
    end,
    heart = function(p)
        local x, y, z = 1.3 * p.x, 1.3 * p.z, 1.3 * p.y
        local body, cube = x * x + 2.25 * y * y + z * z - 1, z * z * z
        return body * body * body - x * x * cube - 0.1125 * y * y * cube
    end,
    metaballs = function(p)
        local sum = 0
        for _, c in ipairs(balls) do
            local x, y, z = p.x - c[1], p.y - c[2], p.z - c[3]
            sum = sum + exp(-10 * (x * x + y * y + z * z))
        end
        return 0.4 - sum
    end,
    twist = function(p)
        local c, s = cos(2 * p.y), sin(2 * p.y)
        local x, y, z = abs(c * p.x + s * p.z) - 0.4, abs(p.y) - 0.8, abs(c * p.z - s * p.x) - 0.4
        x, y, z = max(x, 0.0), max(y, 0.0), max(z, 0.0)
        return sqrt(x * x + y * y + z * z) - 0.1
    end,
    superquadric = function(p) return (abs(p.x) ^ 2.5 + abs(p.z) ^ 2.5) ^ 0.4 + abs(p.y) ^ 0.7 - 0.9 end,
    lattice = function(p)
        local x, y, z = (p.x + 5) % 0.5 - 0.25, (p.y + 5) % 0.5 - 0.25, (p.z + 5) % 0.5 - 0.25
        return sqrt(x * x + y * y + z * z) - 0.2
    end,
    blend = function(p)
        local ring = sqrt(p.x * p.x + p.z * p.z) - 0.6
        local torus, x = sqrt(ring * ring + p.y * p.y) - 0.2, p.x - 0.2
        local ball, rod = sqrt(x * x + p.y * p.y + p.z * p.z) - 0.45, max(sqrt(p.x * p.x + p.z * p.z) - 0.1, abs(p.y) - 0.8)
        return smooth_min(smooth_min(torus, ball, 0.2), rod, 0.15)
    end,
}

local scene = gr.node 'scene'
local paint = gr.material({0.8, 0.6, 0.3}, {0.3, 0.3, 0.3}, 20)
scene:add_child(gr.implicit{f = functions[NAME or 'gyroid'], bounds = {{-1, -1, -1}, {1, 1, 1}}, material = paint})
scene:add_child(gr.plane{normal = {0, 1, 0}, distance = -1.2, material = gr.material({0.5, 0.5, 0.55}, {0, 0, 0}, 1)})
local vertical = math.deg(2 * math.atan(math.tan(math.rad(24)) * 3 / 4))
gr.render{node = scene, file = 'implicit.png', width = 640, height = 480, eye = {2.4, 1.8, 3.2}, target = {0, 0, 0}, fov = vertical,
    ambient = {0.2, 0.2, 0.2}, lights = {gr.light({5, 8, 3}, {0.9, 0.9, 0.9}, {1, 0, 0})}}
