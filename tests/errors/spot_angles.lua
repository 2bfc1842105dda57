-- expect: SCRIPT:2: gr.spot_light: inner must be at most outer, the angle where the light ends
gr.spot_light{position = {0, 0, 0}, colour = {1, 1, 1}, inner = 30, outer = 20}
