-- expect: SCRIPT:2: gr.implicit: bounds[2][1] must be finite
gr.implicit{f = function(p) return p.x end, bounds = {{-1, -1, -1}, {math.huge, 1, 1}}}
