-- expect: SCRIPT:2: gr.render: width must be between 1 and 1048576
gr.render(gr.node('n'), 'no.png', 0, 8, {0, 0, 5}, {0, 0, -1}, {0, 1, 0}, 50, {0, 0, 0}, {})
