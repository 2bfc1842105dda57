-- expect: SCRIPT:2: gr.medium: the temperature of medium_temperature_negative.lua:2 must be at least 0; at p = {0.883311, 0.431528, 0.0264338} it is -0.883311 (gr.max(0.0, x) is never negative)
gr.medium{absorption = {1, 1, 1}, corner = {0, 0, 0}, size = 1, temperature = function(p) return -p.x end}
