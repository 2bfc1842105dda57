-- expect: SCRIPT:2: gr.cylinder comes with version 0.2 (this is 0.1.0)
gr.cylinder('c')
