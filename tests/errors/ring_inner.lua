-- expect: SCRIPT:2: gr.disc: inner must be smaller than radius: 2, 1
gr.disc{inner=2, radius=1}
