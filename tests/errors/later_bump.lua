-- expect: SCRIPT:2: gr.bump comes with version 0.2 (this is 0.1.0)
gr.bump('c')
