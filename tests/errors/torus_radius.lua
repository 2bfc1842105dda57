-- expect: SCRIPT:2: gr.torus: minor must be at least a millionth of major: 1e-07, 1 (node 't')
gr.torus('t', 1, 1e-7)
