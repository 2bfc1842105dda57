-- expect: SCRIPT:2: gr.union: 'p' is flat, so it has no inside; only a plane with a normal is a half-space (node 'u')
gr.union('u', gr.plane('p'), gr.cone('c'))
