-- expect: SCRIPT:2: node:scale must be called with a colon on a node, as in n:scale(...), not on a string
gr.node('a').scale('b', 1, 2, 3)
