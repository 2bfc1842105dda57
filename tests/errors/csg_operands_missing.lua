-- expect: SCRIPT:2: gr.csg_union: operands are missing (node 'u')
gr.csg_union{name='u', operands={}}
