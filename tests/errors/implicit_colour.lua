-- expect: SCRIPT:2: gr.implicit: the function gives a colour; a solid needs one number, below 0 inside
gr.implicit{f = function(p) return {p.x, p.y, p.z} end, bounds = {{-1, -1, -1}, {1, 1, 1}}}
