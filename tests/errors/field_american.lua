-- expect: SCRIPT:2: gr.light: unknown field 'color'; did you mean 'colour'?
gr.light{position = {0, 0, 0}, color = {1, 1, 1}}
