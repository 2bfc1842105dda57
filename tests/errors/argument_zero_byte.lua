-- expect: SCRIPT:2: gr.node: name must not hold a zero byte
gr.node('a\0b')
