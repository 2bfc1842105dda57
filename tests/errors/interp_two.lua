-- expect: SCRIPT:2: gr.wood_pnd_material: interp must be between 0 and 1
gr.wood_pnd_material(gr.material({1, 1, 1}, {0, 0, 0}, 1), 1, 1, 2, {1, 1, 1})
