-- expect: SCRIPT:2: gr.light: falloff, range and intensity exclude each other
gr.light{position = {0, 0, 0}, colour = {1, 1, 1}, falloff = {1, 0, 0}, range = 3}
