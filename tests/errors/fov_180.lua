-- expect: SCRIPT:2: gr.render: fov must be > 0 and < 180
gr.render(gr.node('n'), 'no.png', 8, 8, {0, 0, 5}, {0, 0, -1}, {0, 1, 0}, 180, {0, 0, 0}, {})
