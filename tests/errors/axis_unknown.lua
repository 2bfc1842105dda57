-- expect: SCRIPT:2: node:rotate: axis must be 'x', 'y' or 'z', not 'w' (node 'n')
gr.node('n'):rotate('w', 10)
