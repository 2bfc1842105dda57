-- expect: SCRIPT:2: gr.difference: operands[2] is nil (node 'd')
gr.difference('d', gr.sphere('a'), gr.sphere('b'), gr.sphere('c'), nil, gr.sphere('d'))
