-- expect: SCRIPT:2: node:translate: y must not be NaN (not a number) (node 'n')
gr.node('n'):translate(0, 0 / 0, 0)
