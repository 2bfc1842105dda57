-- expect: SCRIPT:2: gr.directional_light: colour must be a colour {r, g, b}, not a function
gr.directional_light{direction = {0, -1, 0}, colour = function(d) return 1 end}
