-- expect: SCRIPT:2: gr.change_node: matrix flattens everything: it has no inverse (node 'root')
gr.change_node('root', 0, {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0})
