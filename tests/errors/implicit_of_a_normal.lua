-- expect: SCRIPT:2: gr.implicit: the function reads s.normal.x, but a solid is a function of p alone
gr.implicit{f = function(p, s) return p.x + s.normal.x end, bounds = {{-1, -1, -1}, {1, 1, 1}}}
