-- expect: *a picture of 100000 x 100000 pixels is more than gray can hold*
gr.render(gr.node('n'), 'x.png', 100000, 100000, {0, 0, 1}, {0, 0, -1}, {0, 1, 0}, 40, {1, 1, 1}, {})
