-- expect: SCRIPT:2: gr.medium: gray finds no bound of the density of medium_bound_missing.lua:2; give one with bound = NUMBER
gr.medium{scattering = {1, 1, 1}, corner = {-1, -1, -1}, size = 2, density = function(p) return 1 / (p.x * p.x) end}
