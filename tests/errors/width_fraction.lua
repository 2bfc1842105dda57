-- expect: SCRIPT:2: gr.render: width must be a whole number
gr.render(gr.node('n'), 'no.png', 1.5, 8, {0, 0, 5}, {0, 0, -1}, {0, 1, 0}, 50, {0, 0, 0}, {})
