-- expect: SCRIPT:2: gr.fog_field: density must be a function, not a number; write function(p) return ... end
gr.fog_field({-1, -1, -1}, 2, 3)
