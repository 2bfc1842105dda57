-- TITLE: Henge
-- Standing stones in a ring; one trilithon, nine nodes. Every transform is written from the outside in.
-- Author: gray project. Dialect: classic, OLD order (as gray detects from the vertex tables of the lintel).

gr.transform_order('old')
stone = gr.material({0.55, 0.53, 0.5}, {0.08, 0.08, 0.08}, 4)
moss = gr.material({0.38, 0.42, 0.3}, {0.05, 0.05, 0.05}, 4)
grass = gr.material({0.28, 0.45, 0.2}, {0, 0, 0}, 1)

scene = gr.node('scene')

-- a post stands on the origin, a little narrower at the top
post = gr.mesh('post', {
    {-0.5, 0, -0.4}, {0.5, 0, -0.4}, {0.5, 0, 0.4}, {-0.5, 0, 0.4},
    {-0.4, 3, -0.32}, {0.42, 3, -0.3}, {0.4, 3.02, 0.32}, {-0.42, 3, 0.3},
}, { {0, 1, 2, 3}, {7, 6, 5, 4}, {0, 4, 5, 1}, {1, 5, 6, 2}, {2, 6, 7, 3}, {3, 7, 4, 0} })
post:set_material(stone)

lintel = gr.cube('lintel')
lintel:set_material(moss)
lintel:translate(-1.75, 2.95, -0.45)
lintel:scale(3.5, 0.7, 0.9)

trilithon = gr.node('trilithon')
for i = -1, 1, 2 do
    local at = gr.node('leg')
    at:translate(1.1 * i, 0, 0)
    at:rotate('y', 90 + 90 * i)
    at:add_child(post)
    trilithon:add_child(at)
end
trilithon:add_child(lintel)

for i = 0, 8 do
    if i ~= 5 then
        local at = gr.node('ring')
        at:rotate('y', 40 * i)
        at:translate(0, 0, -7)
        at:add_child(trilithon)
        scene:add_child(at)
    end
end
-- one has fallen: laid on its side, lifted, turned, moved out, read from the bottom
fallen = gr.node('fallen')
fallen:rotate('y', 203)
fallen:translate(0, 0.42, -7.5)
fallen:rotate('y', 25)
fallen:rotate('x', 90)
fallen:add_child(post)
scene:add_child(fallen)

altar = gr.cube('altar')
altar:set_material(stone)
altar:rotate('y', 20)
altar:translate(-1.1, -0.1, -0.6)
altar:scale(2.2, 0.7, 1.2)
scene:add_child(altar)

ground = gr.nh_sphere('ground', {0, -400, 0}, 400)
ground:set_material(grass)
scene:add_child(ground)

gr.render(scene, 'henge.png', 480, 320, {3, 6.5, 19}, {-0.15, -0.27, -1}, {0, 1, 0}, 40, {0.3, 0.3, 0.36},
    {gr.light({-20, 14, 6}, {0.85, 0.7, 0.5}, {1, 0, 0}), gr.light({20, 20, 20}, {0.15, 0.17, 0.25}, {1, 0, 0})},
    {background = gr.sky_gradient{stops = {{-0.3, 0.85, 0.7, 0.55}, {0.4, 0.35, 0.45, 0.68}}}})
