-- expect: SCRIPT:2: gr.render: node is missing
gr.render(nil, 'no.png', 8, 8, {0, 0, 5}, {0, 0, -1}, {0, 1, 0}, 50, {0, 0, 0}, {})
