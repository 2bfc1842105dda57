-- TITLE: To print: a vase
-- A profile turned about an axis, with a wall of 2 mm and a row of hollows. Millimetres, z up.
-- Author: gray project

local clay = gr.material({ 0.75, 0.55, 0.45 }, { 0.15, 0.15, 0.15 }, 20)

local function profile(inset, floor)
    local points = { { 26, 0 }, { 30, 12 }, { 42, 45 }, { 40, 80 }, { 24, 115 }, { 20, 130 }, { 30, 150 } }
    local out = { { 0, floor } }
    for i, p in ipairs(points) do
        local y = i == 1 and floor or i == #points and p[2] + (inset > 0 and 1 or 0) or p[2]
        out[#out + 1] = { p[1] - inset, y }
    end
    out[#out + 1] = { 0, out[#out][2] }
    return out
end

local vase = gr.difference { gr.lathe { material = clay, points = profile(0, 0) }, gr.lathe { material = clay, points = profile(2, 3) }, name = 'vase' }
local hollows = {}
for i = 0, 11 do
    local a = math.rad(30 * i)
    hollows[#hollows + 1] = gr.sphere { material = clay, centre = { 47 * math.cos(a), 58, 47 * math.sin(a) }, radius = 7 }
end
local part = gr.difference { vase, gr.union(hollows), name = 'hollowed vase' }

-- The axis of a lathe is y.
local upright = gr.node 'print'
upright:add_child(part)
upright:rotate('x', 90)
upright:export('vase.stl', { tolerance = 0.05 })
upright:export('vase.3mf', { tolerance = 0.05 })

gr.render {
    node = upright, file = 'vase.png', eye = { 170, -240, 190 }, target = { 0, -0, 70 }, fov = 34, width = 300, height = 400, up = { 0, 0, 1 }, ambient = { 0.3, 0.3, 0.32 },
    lights = { gr.light { position = { 300, -400, 500 }, colour = { 0.7, 0.7, 0.7 } }, gr.light { position = { -400, -300, 200 }, colour = { 0.25, 0.25, 0.3 } } },
}
