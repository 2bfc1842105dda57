-- expect: SCRIPT:2: gr.change_node: matrix has 3 numbers, not 12 (node 'root')
gr.change_node('root', 0, {1, 2, 3})
