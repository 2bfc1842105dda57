-- Every gr function and method once, in both forms if there are two; used to test failing allocations.
local plain = gr.material({1, 0.5, 0.2}, {0.5, 0.5, 0.5}, 20)
local glass = gr.rr_material({1, 1, 1}, {1, 1, 1}, 100, 0.1, 0.9, 1.5)
local fresnel = gr.difresnel_material(glass)
fresnel = gr.difresneld_material{material = glass}
local marble = gr.marble_pnd_material(plain, 1, 2, 3, 1, {1, 1, 1})
local wood = gr.wood_pnd_material(marble, 1, 2, 0, {0, 0, 0})
local sides = gr.td_cube_material(wood, 'cross.png')
local around = gr.td_sphere_material{material = sides, png = 'cross.png', filter = 'nearest', flip_u = true}
local texture = gr.texture{file = 'cross.png', wrap = 'mirror'}

local root = gr.node('root')
root:add_child(gr.joint('joint', {0, 1, 2}, {0, 1, 2}))
root:add_child(gr.geometry('g', gr.sphere(around)))
root:add_child(gr.instances{of = gr.sphere(plain), at = {{1, 2, 3}, {3, 2, 1}}, turn = {10, 20}, axis = 'z', size = 2})
root:add_child(gr.instances(gr.cube(plain), {{1, 0, 0, 5, 0, 1, 0, 6, 0, 0, 1, 7}}))
root:add_child(gr.geometry('h', gr.cube(sides)))
local ball = gr.nh_sphere('ball', {0, 0, 0}, 1)
ball:set_material(plain)
ball:set_texture(texture)
ball:set_texture('cross.png')
ball:set_bump(gr.bump('cross.png', 0.1)):set_bump('cross.png'):set_bump(texture)
ball:set_bump(gr.bump{file = 'cross.png', kind = 'normal', tiles = {2, 3}, offset = 0.5, wrap = 'mirror'})
root:add_child(gr.sphere(gr.bump_material(gr.image_material{material = plain, image = texture, channel = 'ks'}, 'cross.png')))
ball:scale(1, 2, 3)
ball:rotate('y', 20)
ball:translate({1, 2, 3})
local box = gr.nh_box('box', {0, 0, 0}, 1)
for _, combine in ipairs({gr.csg_union, gr.csg_difference, gr.csg_intersection, gr.union, gr.difference, gr.intersection}) do
    root:add_child(combine('solid', ball, box))
end
local verts = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}
local faces = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}
for _, make in ipairs({gr.mesh, gr.fast_mesh}) do root:add_child(make(plain, verts, faces)) end
for _, make in ipairs({gr.vn_mesh, gr.fast_vn_mesh}) do root:add_child(make(plain, verts, verts, faces, faces)) end
root:add_child(gr.mesh{material = plain, verts = verts, faces = faces, uvs = {{0, 0}, {1, 0}, {0, 1}, {1, 1}}})
root:add_child(gr.mesh('flag', 'flag.obj'))
root:add_child(gr.lathe(plain, {{0, 0}, {1, 0}, {1, 1}, {0, 2}}, 'catmull-rom'))
root:add_child(gr.prism{material = plain, outline = {{0, 0}, {3, 0}, {0, 3}}, holes = {{{1, 1}, {1.5, 1}, {1, 1.5}}}, to = 2})
root:add_child(gr.sweep(plain, {{0, 0, 0}, {1, 1, 0}, {2, 0, 1}}, {0.1, 0.2, 0.1}))
root:add_child(gr.height_field(plain, {{0, 1, 0}, {1, 0, 1}}))
root:add_child(gr.height_field{material = plain, image = 'cross.png', smooth = true, open = true})
root:add_child(gr.implicit(plain, function(p) return p:length() - 0.3 end, {{-1, -1, -1}, {1, 1, 1}}))
root:add_child(gr.blob(plain, {{0, 0, 0, 1}}, {{0, 0, 0, 1, 0, 0, 0.5, 2}}, 0.4))
root:add_child(gr.curve(plain, {{0, 0, 0}, {1, 1, 0}, {2, 0, 1}}, 0.1, 'b-spline'))
local net = {}
for k = 0, 15 do net[k + 1] = {k % 4, k % 3, k // 4} end
root:add_child(gr.patch{material = plain, points = net, tolerance = 0.05})
gr.transform_order('separate')
root:scale(1, 1, 1)
gr.transform_order('new')
local lamp = gr.light({0, 5, 5}, {1, 1, 1}, {1, 0, 0})
local panel = gr.area_light({0, 5, 0}, {1, 0, 0}, {0, 0, 1}, {1, 1, 1}, {1, 0, 0})
require 'parts.colours'
for key in pairs({z = 1, y = 2, x = 3}) do root:add_child(gr.node(key)) end
pcall(gr.sphere, true)
local step = coroutine.wrap(function() coroutine.yield(gr.node('made in a coroutine')) end)
root:add_child(step())
gr.render(root, 'everything.png', 8, 8, {0, 0, 9}, {0, 0, -1}, {0, 1, 0}, 50, {0, 0, 0}, {lamp, panel})
gr.render_skybox(root, 'everything' .. 2.0 .. '.png', 'cross.png', 8, 8, {0, 0, 9}, {0, 0, -1}, {0, 1, 0}, 50, {0, 0, 0}, {lamp})
gr.render{node = root, file = 'named.png', width = 8, height = 8, eye = {0, 0, 9}, background = {1, 1, 1}, samples = 2}
