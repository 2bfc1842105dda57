-- expect: SCRIPT:2: gr.spherical_light: a light with emission has no falloff, range or intensity
gr.spherical_light{position = {0, 0, 0}, radius = 1, emission = {1, 1, 1}, range = 2}
