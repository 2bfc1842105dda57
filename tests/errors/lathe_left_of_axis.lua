-- expect: SCRIPT:2: gr.lathe: point 2 of the profile has the negative radius -1
gr.lathe{points={{0, 0}, {-1, 1}, {0, 2}}}
