-- expect: SCRIPT:2: gr.render: file must not be empty
gr.render(gr.node('n'), '', 8, 8, {0, 0, 5}, {0, 0, -1}, {0, 1, 0}, 50, {0, 0, 0}, {})
