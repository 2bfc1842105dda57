-- expect: SCRIPT:2: gr.material: kd must have 3 numbers, not 2
gr.material({1, 1}, {0, 0, 0}, 1)
