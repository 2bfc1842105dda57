-- expect: SCRIPT:2: gr.implicit: bounds is missing (or radius), for example bounds = {{-1, -1, -1}, {1, 1, 1}}
gr.implicit{f = function(p) return p.x end}
