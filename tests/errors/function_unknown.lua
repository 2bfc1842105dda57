-- expect: SCRIPT:2: gr.frobnicate does not exist (gray --man lists all)
gr.frobnicate('a')
