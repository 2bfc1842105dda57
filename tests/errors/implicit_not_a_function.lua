-- expect: SCRIPT:2: gr.implicit: f must be a function, not a number; write function(p) return ... end
gr.implicit{f = 7, bounds = {{-1, -1, -1}, {1, 1, 1}}}
