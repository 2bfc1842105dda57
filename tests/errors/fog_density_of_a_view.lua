-- expect: SCRIPT:2: gr.fog_field: the function reads s.view.y, but a density may depend only on the point and the time
gr.fog_field({-1, -1, -1}, 2, function(p, s) return s.view.y end)
