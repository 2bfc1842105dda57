-- expect: SCRIPT:2: gr.csg_union: operands[2] must be a node, not a number; gr.node{...}, gr.sphere{...} and other shapes make nodes (node 'u')
gr.csg_union{name='u', gr.sphere('a'), 7}
