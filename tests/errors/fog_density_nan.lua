-- expect: SCRIPT:2: gr.fog_field: the density of fog_density_nan.lua:2 must be at least 0; at p = {-1.11669, -1.56847, -1.97357} it is not a number (NaN)
gr.fog_field({-2, -2, -2}, 1, function(p) return math.sqrt(p.y) end)
