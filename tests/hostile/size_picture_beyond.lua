-- expect: SCRIPT:2: gr.render: *
gr.render(gr.node('n'), 'x.png', 10000000, 1, {0, 0, 1}, {0, 0, -1}, {0, 1, 0}, 40, {1, 1, 1}, {})
