-- expect: SCRIPT:2: gr.fog_field: the density of fog_density_colour.lua:2 is a colour; it must be a number
gr.fog_field({-1, -1, -1}, 2, function(p) return p end)
