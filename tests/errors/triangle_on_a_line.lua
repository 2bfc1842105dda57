-- expect: SCRIPT:2: gr.triangle: a, b and c lie on one line
gr.triangle{a={0,0,0}, b={1,1,1}, c={2,2,2}}
