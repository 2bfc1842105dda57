-- expect: SCRIPT:2: gr.blob: spheres[1] has 3 numbers, not 4 or 5
gr.blob{spheres={{0, 0, 0}}}
