-- expect: SCRIPT:2: gr.implicit: the function returns a colour; a solid needs one number, negative inside
gr.implicit{f = function(p) return {p.x, p.y, p.z} end, bounds = {{-1, -1, -1}, {1, 1, 1}}}
