local function shiny(r, g, b)
    return gr.material{kd = {r, g, b}, ks = {0.3, 0.3, 0.3}, shininess = 60}
end
local clay, wood = shiny(0.25, 0.45, 0.6), gr.material{kd = {0.55, 0.38, 0.22}}
local gold = gr.metal_material{metal = 'gold', roughness = 0.2}

local ball = gr.sphere{centre = {0, 2, 0}, radius = 2, material = clay}
local foot = gr.cylinder{from = {0, 0, 0}, to = {0, 0.3, 0}, radius = 0.8, material = clay}
local hollow = gr.sphere{centre = {0, 2, 0}, radius = 1.85, material = clay}
local above = gr.box{min = {-3, 1.3, -3}, max = {3, 5, 3}, material = clay}
local bowl = gr.difference{gr.union{ball, foot}, hollow, above}

-- Five marbles on a circle, and one of gold in the middle.
local marbles = gr.node{children = {gr.sphere{centre = {0, 0.5, 0}, radius = 0.35, material = gold}}}
for i = 1, 5 do
    local marble = gr.sphere{radius = 0.35, material = shiny(0.18 * i, 0.15, 0.9 - 0.18 * i)}
    marble:translate(0.9, 0.8, 0)
    marble:rotate('y', 72 * i)
    marbles:add_child(marble)
end

local table_top = gr.cylinder{from = {0, -0.2, 0}, to = {0, 0, 0}, radius = 5, material = wood}
return {marbles = marbles, all = gr.node{children = {bowl, marbles, table_top}}}
