-- expect: SCRIPT:2: gr.medium: scattering[2] must be >= 0
gr.medium{scattering = {1, -1, 1}}
