-- expect: SCRIPT:2: node:translate must be called with a colon on a node, as in n:translate(...), not on a number
gr.node('a').translate(1, 2, 3)
