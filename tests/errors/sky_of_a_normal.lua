-- expect: SCRIPT:2: gr.sky_light: the function reads s.normal.x, but a sky may depend only on the direction
gr.sky_light(function(d, s) return s.normal.x end)
