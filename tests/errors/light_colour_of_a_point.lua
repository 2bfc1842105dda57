-- expect: SCRIPT:2: gr.light: the function reads s.u, but the colour of a light may depend only on the direction
gr.light{position = {0, 1, 0}, colour = function(d, s) return s.u end}
