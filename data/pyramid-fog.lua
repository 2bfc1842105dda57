-- TITLE: A pyramid in the fog
-- Mirror balls in a pyramid, more of them behind, and ground fog: reflections are attenuated over the whole path.
-- With --cutoff 0.002, rays that the fog has almost absorbed are not followed.
-- Author: gray project

local stage = require 'stage'

local root = gr.node('root')
local ground = gr.material({ .42, .40, .36 }, { 0, 0, 0 }, 1)
root:add_child(stage.box('ground', ground, { -60, -1, -90 }, { 60, 0, 20 }))

local metals = {
    gr.rr_material({ .04, .05, .06 }, { .86, .88, .92 }, 200, .85, 0, 1),
    gr.rr_material({ .10, .06, .02 }, { .92, .70, .38 }, 200, .80, 0, 1),
    gr.rr_material({ .08, .03, .02 }, { .86, .46, .36 }, 200, .80, 0, 1),
}

-- `rows` layers of balls of radius r, each ball on top of four others
local function pyramid(x, z, rows, r)
    local step, rise = 2 * r, r * math.sqrt(2)
    for layer = 0, rows - 1 do
        local n = rows - layer
        for i = 0, n - 1 do
            for k = 0, n - 1 do
                local at = { x + (i - (n - 1) / 2) * step, r + layer * rise, z + (k - (n - 1) / 2) * step }
                root:add_child(stage.ball('ball', metals[(i + k + layer) % 3 + 1], at, r))
            end
        end
    end
end

pyramid(0, 0, 6, .5)
for i = 1, 4 do
    pyramid(-7.5 - 1.5 * i, -9 * i, 6, .5)
    pyramid(6.5 + 2.5 * i, -8 * i + 2, 6, .5)
end

local lights = {
    gr.directional_light{ direction = { 1, -1.4, -.8 }, colour = { .85, .75, .6 } },
    gr.light({ -20, 30, 30 }, { .25, .28, .35 }, { 1, 0, 0 }),
}
local mist = gr.height_fog{ density = .17, base = 0, scale = 3, colour = { .72, .74, .78 } }
gr.render{ node = root, file = 'pyramid-fog.png', width = 640, height = 400, eye = { -2.4, 2.5, 10 }, target = { .6, 1.6, 0 },
    fov = 42, ambient = { .2, .2, .22 }, lights = lights, fog = mist, reflect_limit = 8,
    background = { .38, .52, .74 } }
