-- Every analytic shape, with its name below it. Run: ./gray data/solids.lua

local ivory = gr.material({0.86, 0.83, 0.76}, {0.15, 0.15, 0.15}, 30)
local ink = gr.material({0.16, 0.17, 0.22}, {0.1, 0.1, 0.1}, 20)
local ground = gr.material({0.42, 0.46, 0.50}, {0.05, 0.05, 0.05}, 10)

local palette = {
    {0.80, 0.22, 0.16}, {0.88, 0.52, 0.12}, {0.86, 0.74, 0.20},
    {0.28, 0.58, 0.28}, {0.13, 0.46, 0.60}, {0.42, 0.26, 0.56},
}

-- Straight strokes on a grid four wide and six high, from below.
local strokes = {
    A = '004616 4640 1232', B = '00063645340333 33424130 0030', C = '4536160501103041', D = '0006264541200000',
    E = '46060040 0333', F = '460600 0333', G = '4536160501103041422222', H = '0006 4046 0343', I = '1030 2026 1636',
    J = '01103041464626', K = '0006 460340', L = '060040', M = '0006234640', N = '00064046', O = '0501103041453616 1605',
    P = '000636454433 3303', Q = '0501103041453616 1605 2240', R = '0006364544330333 2340', S = '453616050413334241301001',
    T = '0646 2620', U = '060110304146', V = '062046', W = '0610233046', X = '0046 0640', Y = '062346 2320', Z = '06460040',
}

local function write(words, size)
    local text = gr.node(words)
    local unit, x = size / 6, -#words * size * 5.4 / 12 + size / 8
    for letter in words:gmatch '.' do
        for line in (strokes[letter] or ''):gmatch '%d+' do
            local last
            for a, b in line:gmatch '(%d)(%d)' do
                local at = {x + a * unit, b * unit, 0}
                if not last or at[1] ~= last[1] or at[2] ~= last[2] then
                    text:add_child(gr.sphere {name = letter, material = ink, centre = at, radius = unit / 3})
                    if last then
                        text:add_child(gr.cylinder {material = ink, from = last, to = at, radius = unit / 3, open = true})
                    end
                end
                last = at
            end
        end
        x = x + size * 5.4 / 6
    end
    return text
end

local function points_of_a_star(tips, far, near)
    local points = {}
    for k = 0, 2 * tips - 1 do
        local angle, r = math.pi * (k / tips + 0.5), k % 2 == 0 and far or near
        points[#points + 1] = {r * math.cos(angle), r * math.sin(angle), 0}
    end
    return points
end

-- A star with a round hole.
local star, outlines = points_of_a_star(7, 1, 0.62), {{}, {}}
for k = 0, 13 do
    outlines[1][k + 1] = k
end
for k = 0, 31 do
    star[#star + 1] = {0.3 * math.cos(k * math.pi / 16), 0.3 * math.sin(k * math.pi / 16), 0}
    outlines[2][k + 1] = 14 + k
end

local function half_ball(m)
    return gr.difference('half', gr.sphere(m), gr.plane {normal = {-0.6, -0.35, -0.7}, distance = -0.25, material = ivory})
end

-- Each: the word, how to make it, and how it is turned and moved to stand on its step.
local show = {
    {
        {'SPHERE', function(m) return gr.sphere(m):translate(0, 1, 0) end},
        {'CUBE', function(m) return gr.cube(m):translate(-0.5, 0, -0.5):scale(1.4, 1.4, 1.4):rotate('y', 30) end},
        {'BOX', function(m)
            return gr.box {min = {-1, 0, -0.4}, max = {1, 1.3, 0.4}, material = m}:rotate('y', -25)
        end},
        {'ELLIPSOID', function(m)
            return gr.ellipsoid {radii = {1.1, 0.6, 0.7}, material = m}:translate(0, 0.6, 0)
        end},
        {'HALF SPACE', function(m) return half_ball(m):translate(0, 1, 0) end},
        {'RING', function(m)
            return gr.disc {radius = 0.9, inner = 0.5, normal = {-0.35, 0.2, 1}, material = m}:translate(0, 0.9, 0)
        end},
    },
    {
        {'CYLINDER', function(m) return gr.cylinder(m):scale(0.75, 0.8, 0.75):translate(0, 0.8, 0) end},
        {'TUBE', function(m)
            return gr.cylinder {radius = 0.6, open = true, material = m}
                :rotate('x', 62):rotate('y', 24):translate(0, 0.85, 0)
        end},
        {'CONE', function(m) return gr.cone(m):rotate('x', 180):scale(0.9, 1.8, 0.9):translate(0, 1.8, 0) end},
        {'FRUSTUM', function(m)
            return gr.cone {from = {0, 0, 0}, from_radius = 0.95, to = {0.3, 1.5, 0}, radius = 0.45, material = m}
        end},
        {'TORUS', function(m)
            return gr.torus('torus', 0.75, 0.3):set_material(m):rotate('x', 35):translate(0, 0.75, 0)
        end},
        {'APPLE', function(m) return gr.torus {major = 0.35, minor = 0.65, material = m}:translate(0, 0.65, 0) end},
    },
    {
        {'PARABOLOID', function(m)
            return gr.paraboloid {radius = 0.8, height = 1.5, open = true, material = m}:rotate('x', 8)
        end},
        {'ONE SHEET', function(m)
            return gr.hyperboloid {waist = 0.4, radius = 0.85, height = 0.8, material = m}:translate(0, 0.8, 0)
        end},
        {'TWO SHEETS', function(m)
            return gr.hyperboloid {gap = 0.2, radius = 0.85, height = 0.8, material = m}:translate(0, 0.8, 0)
        end},
        {'QUADRIC', function(m)
            return gr.quadric {xx = 1, zz = -1, y = 1, constant = -0.1, min = {-0.8, -0.8, -0.8}, max = {0.8, 0.9, 0.8}, material = m}
                :rotate('y', 35):translate(0, 0.8, 0)
        end},
        {'SQUARE', function(m)
            return gr.plane(m):scale(1.5, 1, 1.5):rotate('x', 75):rotate('y', -15):translate(0, 0.75, 0)
        end},
        {'DISC', function(m)
            return gr.disc {radius = 0.85, normal = {-0.3, 0.2, 1}, material = m}:translate(0, 0.85, 0)
        end},
    },
    {
        {'SUPER A', function(m)
            return gr.superellipsoid {e = 0.3, n = 0.3, material = m}
                :scale(0.8, 0.8, 0.8):rotate('y', 30):translate(0, 0.8, 0)
        end},
        {'SUPER B', function(m)
            return gr.superellipsoid {e = 1, n = 0.25, material = m}:scale(0.85, 0.8, 0.85):translate(0, 0.8, 0)
        end},
        {'SUPER C', function(m)
            return gr.superellipsoid {e = 2, n = 1, material = m}
                :scale(0.95, 0.9, 0.95):rotate('y', 20):translate(0, 0.9, 0)
        end},
        {'SUPER D', function(m)
            return gr.superellipsoid {e = 2.8, n = 2.8, material = m}
                :scale(1.1, 1, 1.1):rotate('y', 20):translate(0, 1, 0)
        end},
        {'TRIANGLE', function(m)
            return gr.triangle {a = {-0.9, 0, 0}, b = {0.9, 0, 0.2}, c = {0.1, 1.6, -0.2}, material = m}
        end},
        {'POLYGON', function(m)
            return gr.polygon {points = star, outlines = outlines, material = m}
                :rotate('y', -15):translate(0, 0.95, 0)
        end},
    },
}

local scene = gr.node('solids')
scene:add_child(gr.plane {normal = {0, 1, 0}, material = ground})
for r, row in ipairs(show) do
    local y, z = 1.9 * r - 1.4, -3.1 * r
    scene:add_child(gr.box {name = 'step', min = {-9.4, 0, z - 1.55}, max = {9.4, y, z + 1.55}, material = ivory})
    for k, entry in ipairs(row) do
        local place, m = gr.node(entry[1]), gr.rr_material(palette[(k + r) % 6 + 1], {0.35, 0.35, 0.35}, 60, 0.12, 0, 1)
        if k > 4 or entry[1] == 'TUBE' or entry[1] == 'PARABOLOID' then
            m = gr.material {kd = palette[(k + r) % 6 + 1], ks = {0.3, 0.3, 0.3}, shininess = 60, two_sided = true}
        end
        place:add_child(entry[2](m))
        place:add_child(write(entry[1], 0.26):translate(0, -0.33, 1.55))
        place:translate(3 * k - 10.5, y, z)
        scene:add_child(place)
    end
end

local lights = {
    gr.area_light({-11, 17, 5}, {4, 0, 0}, {0, 1, 4}, {0.75, 0.73, 0.68}, {1, 0, 0}),
    gr.light({14, 10, 12}, {0.22, 0.24, 0.30}, {1, 0, 0}),
}
gr.render {
    node = scene, file = 'solids.png', width = 1200, height = 800, eye = {0, 12.5, 17}, target = {0, 3.3, -6.9}, fov = 30,
    ambient = {0.30, 0.31, 0.34}, lights = lights, background = {0.62, 0.70, 0.80},
}
