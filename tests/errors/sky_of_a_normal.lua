-- expect: SCRIPT:2: gr.sky_light: the function reads s.normal.x, but a sky is a function of the direction alone
gr.sky_light(function(d, s) return s.normal.x end)
