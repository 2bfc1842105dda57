-- TITLE: Puppet
-- A figure of spheres whose limbs hang on joints; each joint has its initial angles.
-- Author: gray project. Dialect: classic, new order (the hat comes from a file).

local skin = gr.material({0.85, 0.6, 0.45}, {0.15, 0.15, 0.15}, 10)
local shirt = gr.material({0.2, 0.35, 0.7}, {0.2, 0.2, 0.2}, 15)
local trousers = gr.material({0.3, 0.22, 0.16}, {0.1, 0.1, 0.1}, 8)
local shoe = gr.material({0.1, 0.08, 0.08}, {0.4, 0.4, 0.4}, 30)

local function part(name, material, sx, sy, sz, x, y, z)
    local s = gr.sphere(name)
    s:scale(sx, sy, sz)
    s:translate(x or 0, y or 0, z or 0)
    s:set_material(material)
    return s
end

local root = gr.node('root')
root:add_child(part('torso', shirt, 0.9, 1.3, 0.55))
root:add_child(part('shoulders', shirt, 1.15, 0.4, 0.5, 0, 0.85, 0))
root:add_child(part('hips', trousers, 0.8, 0.5, 0.55, 0, -1.15, 0))

local neck = gr.joint('neck', {-20, 8, 20}, {0, 0, 0})
neck:translate(0, 1.25, 0)
root:add_child(neck)
neck:add_child(part('throat', skin, 0.22, 0.35, 0.22, 0, 0.1, 0))
local head = gr.joint('head', {-30, -5, 30}, {-80, 25, 80})
head:translate(0, 0.45, 0)
neck:add_child(head)
head:add_child(part('skull', skin, 0.55, 0.65, 0.58, 0, 0.55, 0))
head:add_child(part('nose', skin, 0.1, 0.12, 0.18, 0, 0.5, 0.6))
for side = -1, 1, 2 do
    head:add_child(part('eye', gr.material({0.95, 0.95, 0.95}, {0.5, 0.5, 0.5}, 50), 0.1, 0.1, 0.06, 0.2 * side, 0.68, 0.51))
    head:add_child(part('pupil', shoe, 0.05, 0.05, 0.04, 0.2 * side, 0.68, 0.56))
    head:add_child(part('ear', skin, 0.1, 0.18, 0.12, 0.55 * side, 0.55, 0))
end
local hat = gr.mesh('hat', 'hat.obj')
hat:scale(0.48, 0.4, 0.48)
hat:rotate('x', -6)
hat:translate(0, 1.05, 0)
hat:set_material(shoe)
head:add_child(hat)

-- {side, shoulder, elbow, hip, knee}: degrees about x
local pose = { {-1, -155, -35, 25, 40}, {1, 20, -60, -40, 25} }
for _, p in ipairs(pose) do
    local side = p[1]
    local shoulder = gr.joint('shoulder', {-180, p[2], 60}, {0, 0, 0})
    shoulder:rotate('z', side * 12)
    shoulder:translate(side * 1.1, 0.9, 0)
    root:add_child(shoulder)
    shoulder:add_child(part('upper arm', shirt, 0.26, 0.65, 0.26, 0, -0.55, 0))
    local elbow = gr.joint('elbow', {-150, p[3], 0}, {0, 0, 0})
    elbow:translate(0, -1.1, 0)
    shoulder:add_child(elbow)
    elbow:add_child(part('lower arm', skin, 0.2, 0.6, 0.2, 0, -0.5, 0))
    local wrist = gr.joint('wrist', {-60, -10, 60}, {0, 0, 0})
    wrist:translate(0, -1.05, 0)
    elbow:add_child(wrist)
    wrist:add_child(part('hand', skin, 0.2, 0.28, 0.12, 0, -0.2, 0))

    local hip = gr.joint('hip', {-90, p[4], 60}, {0, 0, 0})
    hip:translate(side * 0.45, -1.3, 0)
    root:add_child(hip)
    hip:add_child(part('thigh', trousers, 0.34, 0.85, 0.36, 0, -0.7, 0))
    local knee = gr.joint('knee', {0, p[5], 120}, {0, 0, 0})
    knee:translate(0, -1.45, 0)
    hip:add_child(knee)
    knee:add_child(part('shin', trousers, 0.26, 0.8, 0.28, 0, -0.7, 0))
    local ankle = gr.joint('ankle', {-40, -15, 40}, {0, 0, 0})
    ankle:translate(0, -1.45, 0)
    knee:add_child(ankle)
    ankle:add_child(part('foot', shoe, 0.26, 0.18, 0.5, 0, -0.05, 0.25))
end
root:rotate('y', -20)

gr.render(root, 'puppet.png', 300, 400, {0, -0.4, 14}, {0, 0, -1}, {0, 1, 0}, 40, {0.35, 0.35, 0.35},
    {gr.light({-8, 10, 12}, {0.7, 0.7, 0.65}, {1, 0, 0}), gr.light({8, 0, 8}, {0.25, 0.25, 0.3}, {1, 0, 0})},
    {background = {0.6, 0.66, 0.7}})
