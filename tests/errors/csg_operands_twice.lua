-- expect: SCRIPT:2: gr.csg_union: operands are given twice, with and without a name (node 'u')
gr.csg_union{name='u', gr.sphere('a'), operands={gr.sphere('b')}}
