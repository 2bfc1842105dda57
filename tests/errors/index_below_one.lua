-- expect: SCRIPT:2: gr.rr_material: ior must be >= 1
gr.rr_material({1, 1, 1}, {1, 1, 1}, 1, 0, 1, 0.5)
