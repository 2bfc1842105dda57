-- expect: SCRIPT:2: gr.change_node: matrix is singular: it has no inverse (node 'root')
gr.change_node('root', 0, {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0})
