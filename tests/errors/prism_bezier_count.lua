-- expect: SCRIPT:2: gr.prism: curve 1 of the outline: a Bezier spline that is closed needs 3 n points, not 4
gr.prism{outline={{0, 0}, {1, 0}, {1, 1}, {0, 1}}, spline='bezier'}
