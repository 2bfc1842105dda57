-- expect: SCRIPT:2: gr.inverse: 'c' has no caps (open = true), so it has no inside (node 'n')
gr.inverse('n', gr.cylinder{name='c', open=true})
