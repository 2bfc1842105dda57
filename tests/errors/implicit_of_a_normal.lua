-- expect: SCRIPT:2: gr.implicit: the function reads s.normal.x, but a solid may depend only on p
gr.implicit{f = function(p, s) return p.x + s.normal.x end, bounds = {{-1, -1, -1}, {1, 1, 1}}}
