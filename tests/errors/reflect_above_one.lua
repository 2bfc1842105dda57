-- expect: SCRIPT:2: gr.rr_material: reflect must be between 0 and 1
gr.rr_material({1, 1, 1}, {1, 1, 1}, 1, 1.5, 0, 1.5)
