-- expect: SCRIPT:2: gr.fog_field: the density of fog_density_negative.lua:2 must be at least 0; at p = {0.766622, -0.136944, -0.947132} it is -0.136944 (gr.max(0.0, x) is never negative)
gr.fog_field({-1, -1, -1}, 2, function(p) return p.y end)
