-- expect: SCRIPT:2: node:trasnlate does not exist; did you mean node:translate? (node 'a')
gr.node('a'):trasnlate(1, 2, 3)
