-- expect: SCRIPT:2: gr.frobnicate does not exist
gr.frobnicate('a')
