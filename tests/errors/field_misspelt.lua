-- expect: SCRIPT:2: gr.light: unknown field 'positon'; did you mean 'position'?
gr.light{positon = {0, 0, 0}, colour = {1, 1, 1}}
