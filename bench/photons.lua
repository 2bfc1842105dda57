-- The simple scene of bench/photons.sh: two balls of glass, a ring of gold and a pane on a floor, a lamp and a distant light.
local root = gr.node('root')
local floor = gr.material({ .8, .8, .8 }, { 0, 0, 0 }, 1)
local glass = gr.difresnel_material(gr.rr_material({ 0, 0, 0 }, { 1, 1, 1 }, 200, 0, 1, 1.5))
local gold = gr.rr_material({ .2, .15, .05 }, { .95, .75, .35 }, 80, .85, 0, 1)

local function add(node, material)
    if material then node:set_material(material) end
    root:add_child(node)
    return node
end

add(gr.nh_box('floor', { -20, -1, -20 }, 40), floor):scale(1, 1 / 40, 1)
add(gr.nh_sphere('one', { -1.2, .8, 0 }, .8), glass)
add(gr.nh_sphere('other', { .9, .5, 1.2 }, .5), glass)
add(gr.lathe { name = 'ring', material = gold, loop = true, points = { { .9, 0 }, { .96, 0 }, { .96, .5 }, { .9, .5 } } }):translate(1.6, 0, -1)
local pane = add(gr.cube('pane'), glass)
pane:translate(-3, 0, -1.5)
pane:scale(.1, 2, 2.5)

gr.render {
    node = root, file = 'photons.png', width = 640, height = 480,
    eye = { 0, 5, 8 }, target = { 0, .3, 0 }, fov = 40,
    ambient = { .1, .1, .1 }, background = { .4, .5, .7 },
    caustics = { photons = PHOTONS or 0 },
    lights = {
        gr.directional_light({ .6, -.7, .2 }, { .7, .7, .7 }),
        gr.disc_light { position = { 2, 6, 3 }, normal = { 0, -1, 0 }, radius = .3, emission = { 60, 55, 50 } },
    },
}
