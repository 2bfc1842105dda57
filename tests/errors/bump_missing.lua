-- expect: SCRIPT:2: gr.bump: cannot find 'no.png' (looked in ., Assets, ../Assets)
gr.bump('no.png')
