-- expect: SCRIPT:2: gr.render: lights[1] must be a light, not a node; gr.light{position = {x, y, z}, colour = {r, g, b}} makes a light
gr.render(gr.node('n'), 'no.png', 8, 8, {0, 0, 5}, {0, 0, -1}, {0, 1, 0}, 50, {0, 0, 0}, {gr.node('lamp')})
