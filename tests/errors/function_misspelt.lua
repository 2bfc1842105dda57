-- expect: SCRIPT:2: gr.shpere does not exist; did you mean gr.sphere?
gr.shpere('a')
