-- expect: SCRIPT:2: gr.medium: corner and size are missing: the box in which the density is a function
gr.medium{scattering = {1, 1, 1}, density = function(p) return p.x end}
