-- expect: SCRIPT:2: gr.td_cube_material: *lies outside
gr.td_cube_material(gr.material({1, 1, 1}, {1, 1, 1}, 1), '/etc/passwd')
