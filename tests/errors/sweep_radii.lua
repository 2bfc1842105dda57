-- expect: SCRIPT:2: gr.sweep: radii has 3 entries, but points has 2
gr.sweep{points={{0, 0, 0}, {1, 0, 0}}, radii={1, 2, 3}}
