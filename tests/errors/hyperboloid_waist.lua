-- expect: SCRIPT:2: gr.hyperboloid: waist must be smaller than radius: 2, 1
gr.hyperboloid{waist=2, radius=1}
