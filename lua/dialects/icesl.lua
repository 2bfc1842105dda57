-- Scenes of IceSL, a modeller for 3D printers: solids are values, `translate(1, 2, 3) * solid` moves one, and emit(solid)
-- adds it to the scene. After the scene, all emitted solids are rendered to icesl.png. z points up.
-- docs/dialects.md lists the calls of the dialect.
local sin, rad, sqrt = math.sin, math.rad, math.sqrt
local ipairs, type = ipairs, type
local brushes = {[0] = gr.material({0.8, 0.8, 0.75})}
local root = gr.node('emitted')

-- Vectors: v(x, y, z), with + - and products.
local vector = {}
function v(x, y, z)
    return setmetatable({x, y, z or 0, x = x, y = y, z = z or 0}, vector)
end
function vector.__add(a, b) return v(a[1] + b[1], a[2] + b[2], a[3] + b[3]) end
function vector.__sub(a, b) return v(a[1] - b[1], a[2] - b[2], a[3] - b[3]) end
function vector.__unm(a) return v(-a[1], -a[2], -a[3]) end
function vector.__mul(a, b)
    if type(a) == 'number' then return v(a * b[1], a * b[2], a * b[3]) end
    return b * a
end
X, Y, Z = v(1, 0, 0), v(0, 1, 0), v(0, 0, 1)

local function triple(x, y, z)
    if type(x) == 'table' then return {x[1], x[2], x[3] or 0} end
    return {x, y or x, z or x}
end

-- A solid has a function `build` that makes a node with a material; a transform has a function `apply` that changes a
-- node. The right operand of * is a solid or a transform.
local transform = {}
local function solid(build) return {build = build} end
local function change(apply) return setmetatable({apply = apply}, transform) end
function transform.__mul(a, b)
    if b.apply then
        return change(function(node) b.apply(node) a.apply(node) end)
    end
    return solid(function(material)
        local node = gr.node('moved')
        node:add_child(b.build(material))
        a.apply(node)
        return node
    end)
end
function translate(...)
    local by = triple(...)
    return change(function(node) node:translate(by) end)
end
function scale(...)
    local by = triple(...)
    return change(function(node) node:scale(by) end)
end
-- rotate(angle, axis), or angles about x, y and z
function rotate(a, b, c)
    if type(b) == 'table' then return change(function(node) node:rotate_axis({b[1], b[2], b[3]}, a) end) end
    return change(function(node) node:rotate('x', a):rotate('y', b):rotate('z', c) end)
end
-- The reflection in the plane through the origin with this normal: a rotation by 180 degrees about the normal, then a
-- reflection through the origin.
function mirror(n)
    return change(function(node) node:rotate_axis({n[1], n[2], n[3]}, 180):scale(-1, -1, -1) end)
end

local function box(x, y, z, low)
    local size = triple(x, y, z)
    local corner = {-size[1] / 2, -size[2] / 2, low and 0 or -size[3] / 2}
    return solid(function(material) return gr.nh_box(material, corner, size) end)
end
function cube(x, y, z) return box(x, y, z, true) end
function ccube(x, y, z) return box(x, y, z, false) end
_G.box, cbox = cube, ccube
function sphere(radius, centre)
    local at = centre and triple(centre) or {0, 0, 0}
    return solid(function(material) return gr.nh_sphere(material, at, radius) end)
end
local function frustum(from, to, from_radius, to_radius)
    return solid(function(material)
        if from_radius == to_radius then
            return gr.cylinder{material = material, from = from, to = to, radius = from_radius}
        end
        return gr.cone{material = material, from = from, to = to, from_radius = from_radius, radius = to_radius}
    end)
end
function cone(r0, r1, h, to)
    if to then return frustum(triple(h), triple(to), r0, r1) end
    return frustum({0, 0, 0}, {0, 0, h}, r0, r1)
end
function ccone(r0, r1, h) return frustum({0, 0, -h / 2}, {0, 0, h / 2}, r0, r1) end
function cylinder(r, h, to) return cone(r, r, h, to) end
function ccylinder(r, h) return ccone(r, r, h) end
-- A polygon in the plane z = 0, extruded along z by the length of the direction.
function linear_extrude(direction, points)
    local outline = {}
    for i, p in ipairs(points) do outline[i] = {p[1], -p[2]} end
    return solid(function(material)
        return gr.prism{material = material, outline = outline, to = triple(direction)[3]}:rotate('x', 90)
    end)
end
-- load(file) reads a mesh; with a Lua text it still compiles the text.
local compile = load
function load(file, ...)
    if type(file) == 'string' and file:find('%.%a+$') and not file:find('\n') then
        return solid(function(material) return gr.mesh{material = material, file = file} end)
    end
    return compile(file, ...)
end
Path = ''

local function combine(name)
    return function(first, ...)
        local parts = first.build and {first, ...} or first
        return solid(function(material)
            local nodes = {}
            for i, part in ipairs(parts) do nodes[i] = part.build(material) end
            return #nodes > 1 and gr[name](nodes) or nodes[1]
        end)
    end
end
union, difference, intersection = combine 'union', combine 'difference', combine 'intersection'
merge, U, D, I = union, union, difference, intersection

function set_brush_color(brush, r, g, b) brushes[brush] = gr.material({r, g, b}) end
function emit(what, brush) root:add_child(what.build(brushes[brush or 0] or brushes[0])) end
function ui_scalar(_, default) return default end
ui_number, ui_bool = ui_scalar, ui_scalar
function set_setting_value() end

-- The picture shows the whole scene from the front, the right and above.
local function finish()
    local low, high = root:bounds()
    local centre, size = {}, 0
    for k = 1, 3 do
        centre[k] = (low[k] + high[k]) / 2
        size = size + (high[k] - low[k]) ^ 2
    end
    local fov, direction = 30, {0.45, -0.75, 0.5}
    local distance = sqrt(size) / 2 / sin(rad(fov / 2))
    local eye = {}
    for k = 1, 3 do eye[k] = centre[k] + distance * direction[k] end
    local light = gr.directional_light({-0.3, 0.6, -0.8}, {0.8, 0.8, 0.8})
    gr.render{node = root, file = 'icesl.png', width = 640, height = 480, eye = eye, target = centre, up = {0, 0, 1},
              fov = fov, ambient = {0.3, 0.3, 0.3}, lights = {light}, background = {0.95, 0.95, 0.95}}
end
return {finish = finish}
