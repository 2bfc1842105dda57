-- expect: SCRIPT:2: gr.cylinder: from and to are the same point
gr.cylinder{from={1,2,3}, to={1,2,3}}
