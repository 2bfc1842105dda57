-- expect: SCRIPT:2: gr.medium: g must be > -1 and < 1
gr.medium{scattering = {1, 1, 1}, g = 1}
