-- expect: SCRIPT:2: gr.medium: the density of medium_density_nan.lua:2 must be at least 0; at p = {0.766622, -0.136944, -0.947132} it is not a number (NaN)
gr.medium{scattering = {1, 1, 1}, corner = {-1, -1, -1}, size = 2, density = function(p) return p.y ^ 0.5 end}
