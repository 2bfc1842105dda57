-- expect: SCRIPT:2: gr.render: lights must be a table of lights, not a light; write it in braces, as in {light}
gr.render(gr.node('n'), 'no.png', 8, 8, {0, 0, 5}, {0, 0, -1}, {0, 1, 0}, 50, {0, 0, 0}, gr.light({0, 0, 0}, {1, 1, 1}))
