-- expect: SCRIPT:2: gr.change_light: linear is singular: it has no inverse
gr.change_light(1, {0, 0, 0}, {1, 1, 1}, {1, 0, 0, 0, 1, 0, 0, 0, 0})
