-- Sketches of Processing in Lua: size(), fill(), pushMatrix(), translate(), box(), sphere(). setup() and draw() are called
-- after the scene, once each, and the picture is sketch.png. y points down, lengths are pixels, colours are 0 to 255.
-- docs/dialects.md lists the calls of the dialect.
local tan, rad, deg = math.tan, math.rad, math.deg
local root = gr.node('sketch')
root:scale(1, -1, 1)
local current, stack, lamps = root, {}, {}
local material, ambient, sky = gr.material({1, 1, 1}), {0, 0, 0}, {0.8, 0.8, 0.8}
local vertices

P3D, PI, TWO_PI, HALF_PI, QUARTER_PI = 'P3D', math.pi, 2 * math.pi, math.pi / 2, math.pi / 4
width, height, frameCount = 100, 100, 1
radians, degrees, random = rad, deg, function(low, high)
    if not high then low, high = 0, low end
    return low + (high - low) * math.random()
end
function map(x, a, b, c, d) return c + (d - c) * (x - a) / (b - a) end
function size(w, h) width, height = w, h end

-- One number is a gray.
local function colour(r, g, b)
    return {r / 255, (g or r) / 255, (b or r) / 255}
end
function background(...) sky = colour(...) end
function fill(...) material = gr.material(colour(...)) end
function noStroke() end
stroke, noFill, smooth, sphereDetail, strokeWeight = noStroke, noStroke, noStroke, noStroke, noStroke

function ambientLight(...)
    local c = colour(...)
    for k = 1, 3 do ambient[k] = ambient[k] + c[k] end
end
function directionalLight(r, g, b, x, y, z) lamps[#lamps + 1] = gr.directional_light({x, -y, z}, colour(r, g, b)) end
function pointLight(r, g, b, x, y, z) lamps[#lamps + 1] = gr.light({x, -y, z}, colour(r, g, b), {1, 0, 0}) end
function lights()
    ambientLight(128)
    directionalLight(128, 128, 128, 0, 0, -1)
end

-- A transform acts on everything that is drawn after it: it begins a group below the current one.
local function below()
    local group = gr.node('group')
    current:add_child(group)
    current = group
    return group
end
function pushMatrix() stack[#stack + 1] = current end
function popMatrix() current = table.remove(stack) end
function translate(x, y, z) below():translate(x, y, z or 0) end
function scale(x, y, z) below():scale(x, y or x, z or y and 1 or x) end
function rotateX(a) below():rotate('x', deg(a)) end
function rotateY(a) below():rotate('y', deg(a)) end
function rotateZ(a) below():rotate('z', deg(a)) end
rotate = rotateZ

function sphere(r) current:add_child(gr.nh_sphere(material, {0, 0, 0}, r)) end
function box(w, h, d)
    h, d = h or w, d or w
    current:add_child(gr.nh_box(material, {-w / 2, -h / 2, -d / 2}, {w, h, d}))
end
function beginShape() vertices = {} end
function vertex(x, y, z) vertices[#vertices + 1] = {x, y, z or 0} end
function endShape()
    local face = {}
    for i = 1, #vertices do face[i] = i - 1 end
    current:add_child(gr.mesh(material, vertices, {face}))
end

local function finish()
    if setup then setup() end
    if draw then
        current = root
        draw()
    end
    local distance = height / 2 / tan(PI / 6)
    gr.render{node = root, file = 'sketch.png', width = width, height = height,
              eye = {width / 2, -height / 2, distance}, view = {0, 0, -1}, fov = 60, ambient = ambient, lights = lamps,
              background = sky}
end
return {finish = finish}
