-- expect: SCRIPT:4: gr.render: node 'b' moves inside of a combined solid; only the solid as a whole can move
local b = gr.sphere('b'):velocity(1, 0, 0)
local solid = gr.difference{name = 's', a = gr.sphere('a'), b = b}
gr.render(solid, 'x.png', 8, 8, {0, 0, 5}, {0, 0, -1}, {0, 1, 0}, 50, {0, 0, 0}, {})
