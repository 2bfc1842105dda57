-- expect: *huge.png: *
gr.td_cube_material(gr.material({1, 1, 1}, {1, 1, 1}, 1), 'huge.png')
