-- expect: SCRIPT:2: gr.disc_light: colour is missing
gr.disc_light{position = {0, 0, 0}, normal = {0, 1, 0}, radius = 1}
