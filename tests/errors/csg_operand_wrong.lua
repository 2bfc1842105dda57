-- expect: SCRIPT:2: gr.csg_union: operands[2] must be a node, not a number (node 'u')
gr.csg_union{name='u', gr.sphere('a'), 7}
