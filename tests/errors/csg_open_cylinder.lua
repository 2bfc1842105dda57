-- expect: SCRIPT:2: gr.csg_difference: 'tube' has no caps (open = true), so it has no inside (node 'd')
gr.csg_difference('d', gr.sphere('s'), gr.cylinder{name='tube', open=true})
