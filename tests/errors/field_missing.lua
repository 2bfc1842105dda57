-- expect: SCRIPT:2: gr.light: position is missing
gr.light{colour = {1, 1, 1}}
