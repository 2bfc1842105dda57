-- expect: SCRIPT:2: gr.material: kd[2] must be a number, not nil
gr.material({1, nil, 1}, {0, 0, 0}, 1)
