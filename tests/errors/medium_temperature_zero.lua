-- expect: SCRIPT:2: gr.medium: temperature must be > 0
gr.medium{absorption = {1, 1, 1}, temperature = 0}
