-- Twin of solids.pov: three CSG solids, sixteen of each other's kind, marble with four octaves and wood. -al-samples 4.
local function finish(colour)
    return gr.material({0.75 * colour[1], 0.75 * colour[2], 0.75 * colour[3]}, {0.4, 0.4, 0.4}, 30)
end
local marble = gr.marble_pnd_material(finish{0.95, 0.93, 0.90}, 1.4, 6, 4.5, 0, {0.19, 0.165, 0.19})
local wood = gr.wood_pnd_material(finish{0.70, 0.45, 0.22}, 0.8, 7, 0, {0.225, 0.12, 0.045})

local function part(shape, material)
    shape:set_material(material)
    return shape
end

local function cross(material)
    local body = gr.csg_intersection('body', part(gr.box{min = {-0.8, -0.8, -0.8}, max = {0.8, 0.8, 0.8}}, material),
                                     part(gr.nh_sphere('ball', {0, 0, 0}, 1.08), material))
    for _, axis in ipairs{{2, 0, 0}, {0, 2, 0}, {0, 0, 2}} do
        local hole = gr.cylinder{from = {-axis[1], -axis[2], -axis[3]}, to = axis, radius = 0.45}
        body = gr.csg_difference('cross', body, part(hole, material))
    end
    return body
end

local function bitten(material)
    local body = gr.csg_difference('corner', part(gr.nh_sphere('ball', {0, 0, 0}, 0.9), material),
                                   part(gr.box{min = {0, 0, -1}, max = {1, 1, 1}}, material))
    return gr.csg_difference('bite', body, part(gr.nh_sphere('bite', {-0.5, 0.5, 0.6}, 0.45), material))
end

local function hut(material)
    local cone = part(gr.cone{from = {0, 1.1, 0}, from_radius = 0.1, to = {0, -0.9, 0}, radius = 0.95}, material)
    local body = gr.csg_intersection('walls', cone, part(gr.box{min = {-0.7, -0.9, -0.7}, max = {0.7, 0.8, 0.7}}, material))
    return gr.csg_intersection('hut', body, part(gr.nh_sphere('ball', {0, -0.2, 0}, 0.95), material))
end

local scene = gr.node('scene')
local floor_look = gr.td_cube_material{material = gr.material({0.5, 0.5, 0.5}, {0, 0, 0}, 1), png = 'checker28_brown.png', filter = 'nearest'}
scene:add_child(gr.nh_box(floor_look, {-14, -28.01, -14}, 28))
local makers = {[0] = cross, bitten, hut}
for i = 0, 15 do
    local solid = gr.node('solid')
    solid:add_child(makers[i % 3](i % 2 == 0 and marble or wood))
    solid:rotate('y', -31 * i)
    solid:translate(2.4 * (i % 4) - 3.6, 0.95, -(2.4 * (i // 4) - 3.2))
    scene:add_child(solid)
end
local lamp = gr.area_light({4.75, 11, 5.75}, {2.5, 0, 0}, {0, 0, 2.5}, {1, 1, 1}, {1, 0, 0})
local vertical = math.deg(2 * math.atan(math.tan(math.rad(22.5)) * 3 / 4))
gr.render{node = scene, file = 'solids.png', width = 640, height = 480, eye = {0, 6, 12}, view = {0, -5.2, -12},
          up = {0, 1, 0}, fov = vertical, ambient = {0.107, 0.107, 0.107}, lights = {lamp},
          background = {0.15, 0.18, 0.25}}
