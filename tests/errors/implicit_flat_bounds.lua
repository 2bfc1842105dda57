-- expect: SCRIPT:2: gr.implicit: the bounds must have a length, a width and a height, and end
gr.implicit{f = function(p) return p.x end, bounds = {{-1, -1, -1}, {1, -1, 1}}}
