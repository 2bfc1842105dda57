-- expect: SCRIPT:2: gr.implicit: f is missing
gr.implicit{bounds = {{-1, -1, -1}, {1, 1, 1}}}
