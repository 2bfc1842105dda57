-- TITLE: Village
-- Houses around a green, written for Lua 5.0: unpack, table.getn, math.mod, and tables that shadow the library's.
-- Author: gray project. Dialect: classic, OLD order (as gray detects from a bare unpack).

gr.transform_order('old')
table_top = nil
local colours = { {0.8, 0.75, 0.6}, {0.75, 0.5, 0.4}, {0.6, 0.65, 0.7}, {0.85, 0.8, 0.75} }
local walls = {}
for i = 1, table.getn(colours) do
    local r, g, b = unpack(colours[i])
    walls[i] = gr.material({r, g, b}, {0.05, 0.05, 0.05}, 5)
end
local tile = gr.material({0.55, 0.2, 0.12}, {0.1, 0.1, 0.1}, 6)
local dark = gr.material({0.18, 0.12, 0.1}, {0.2, 0.2, 0.2}, 20)
local leaf = gr.material({0.2, 0.45, 0.15}, {0.05, 0.05, 0.05}, 5)
local bark = gr.material({0.35, 0.24, 0.15}, {0, 0, 0}, 1)
local lawn = gr.material({0.35, 0.55, 0.25}, {0, 0, 0}, 1)
local water = gr.material({0.2, 0.35, 0.6}, {0.6, 0.6, 0.6}, 60)

scene = gr.node('village')

ground = gr.cube('ground')
ground:set_material(lawn)
ground:translate(-30, -1, -30)
ground:scale(60, 1, 60)
scene:add_child(ground)

function house(kind)
    local h = gr.node('house')
    local body = gr.cube('body')
    body:set_material(walls[kind])
    body:translate(-1, 0, -0.75)
    body:scale(2, 1.2, 1.5)
    h:add_child(body)
    -- the roof is a prism from five faces
    local roof = gr.mesh('roof', {
        {-1.2, 1.2, -0.95}, {1.2, 1.2, -0.95}, {1.2, 1.2, 0.95}, {-1.2, 1.2, 0.95}, {-1.2, 2.1, 0}, {1.2, 2.1, 0},
    }, { {0, 1, 2, 3}, {3, 2, 5, 4}, {1, 0, 4, 5}, {0, 3, 4}, {2, 1, 5} })
    roof:set_material(tile)
    h:add_child(roof)
    local door = gr.cube('door')
    door:set_material(dark)
    door:translate(-0.2, 0, 0.74)
    door:scale(0.4, 0.75, 0.05)
    h:add_child(door)
    for i = -1, 1, 2 do
        local window = gr.cube('window')
        window:set_material(water)
        window:translate(0.62 * i - 0.17, 0.5, 0.74)
        window:scale(0.34, 0.34, 0.04)
        h:add_child(window)
    end
    local chimney = gr.cube('chimney')
    chimney:set_material(tile)
    chimney:translate(0.55, 1.4, -0.35)
    chimney:scale(0.25, 0.9, 0.25)
    h:add_child(chimney)
    return h
end

function tree()
    local t = gr.node('tree')
    local trunk = gr.cube('trunk')
    trunk:set_material(bark)
    trunk:translate(-0.1, 0, -0.1)
    trunk:scale(0.2, 1, 0.2)
    t:add_child(trunk)
    for i = 0, 2 do
        local crown = gr.sphere('crown')
        crown:set_material(leaf)
        crown:translate(0, 1.2 + 0.45 * i, 0)
        crown:scale(0.8 - 0.2 * i, 0.45, 0.8 - 0.2 * i)
        t:add_child(crown)
    end
    return t
end

local kinds = {}
for i = 1, 4 do kinds[i] = house(i) end
local spruce = tree()
local count = 9
for i = 0, count - 1 do
    local at = gr.node('plot')
    -- read from the bottom: out to the ring, then around it
    at:rotate('y', 360 / count * i + 10)
    at:translate(0, 0, -6.5)
    at:add_child(kinds[math.mod(i, 4) + 1])
    local garden = gr.node('garden')
    garden:translate(1.9, 0, 0.6)
    garden:scale(unpack({1, 1 + 0.2 * math.mod(i, 3), 1}))
    garden:add_child(spruce)
    at:add_child(garden)
    scene:add_child(at)
end

pond = gr.sphere('pond')
pond:set_material(water)
pond:translate(0.5, 0, 0.5)
pond:scale(2, 0.05, 1.4)
scene:add_child(pond)

gr.render(scene, 'village.png', 480, 320, {0, 9, 17}, {0, -0.55, -1}, {0, 1, 0}, 42, {0.35, 0.35, 0.4},
    {gr.light({-15, 20, 12}, {0.75, 0.7, 0.6}, {1, 0, 0})},
    {background = {0.55, 0.68, 0.85}})
