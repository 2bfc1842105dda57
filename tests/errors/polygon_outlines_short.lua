-- expect: SCRIPT:2: gr.polygon: outlines[2] has 2 corners, not 3 or more
gr.polygon{points={{0,0,0},{1,0,0},{1,1,0}}, outlines={{0,1,2},{0,1}}}
