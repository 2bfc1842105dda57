-- expect: SCRIPT:2: gr.patch: points has 2 entries, not 16 for each patch
gr.patch{points={{0, 0, 0}, {1, 0, 0}}}
