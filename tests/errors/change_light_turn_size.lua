-- expect: SCRIPT:2: gr.change_light: linear has 3 numbers, not 9
gr.change_light(1, {0, 0, 0}, {1, 1, 1}, {1, 0, 0})
