-- TITLE: Animation: waves of columns
-- A seamless loop: rings run outwards over a field of columns. The columns turn as they rise, and are narrow enough not
-- to touch their neighbours. The projection is orthographic.
-- Author: gray project

local colour = require 'colour'

local SIDE = 15
local scene, columns = gr.node 'field', {}
for j = 1, SIDE do
    for i = 1, SIDE do
        local x, z = i - (SIDE + 1) / 2, j - (SIDE + 1) / 2
        local far = math.sqrt(x * x + z * z)
        if far < SIDE / 2 + 0.1 then
            local r, g, b = table.unpack(far < 3.6 and colour.blend({ 1.0, 0.76, 0.26 }, { 0.93, 0.34, 0.36 }, far / 3.6) or
                colour.blend({ 0.93, 0.34, 0.36 }, { 0.27, 0.30, 0.72 }, math.min(1, far / 3.6 - 1)))
            local node = gr.node 'column'
            node:add_child(gr.box { min = { -0.35, 0, -0.35 }, max = { 0.35, 1, 0.35 },
                material = gr.material({ r, g, b }, { 0.25, 0.25, 0.25 }, 30) })
            scene:add_child(node)
            columns[#columns + 1] = { node = node, x = x, z = z, far = far }
        end
    end
end
scene:add_child(gr.plane { normal = { 0, 1, 0 }, material = gr.material { kd = { 0.90, 0.88, 0.84 } } })

local lights = {
    gr.light({ -12, 20, 6 }, { 0.66, 0.63, 0.58 }, { 1, 0, 0 }), gr.light({ 14, 12, 14 }, { 0.22, 0.24, 0.30 }, { 1, 0, 0 }),
}
gr.frames {
    count = 36, loop = true, pure = true, fps = 25,
    draw = function(t)
        for _, c in ipairs(columns) do
            local wave = 0.5 + 0.5 * math.sin(2 * math.pi * (t - c.far / 6))
            local rise = wave * wave * (3 - 2 * wave)
            c.node:reset():scale(1, 0.5 + 2.6 * rise, 1):rotate('y', 90 * rise):translate(c.x, 0, c.z)
        end
        return {
            node = scene, width = 320, height = 240, eye = { 20, 19, 20 }, target = { 0, 0.7, 0 }, projection = 'orthographic', view_height = 13.5,
            ambient = { 0.30, 0.30, 0.33 }, background = { 0.90, 0.88, 0.84 }, lights = lights,
        }
    end,
}
