-- expect: SCRIPT:2: gr.polygon: this is not a polygon: its points do not lie in one plane
gr.polygon{points={{0,0,0},{1,0,0},{1,1,0},{0,1,1}}}
