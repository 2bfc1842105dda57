-- expect: SCRIPT:2: gr.material: kd[2] must be a number, not a string
gr.material({1, 'x', 1}, {0, 0, 0}, 1)
