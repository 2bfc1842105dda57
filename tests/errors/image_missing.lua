-- expect: SCRIPT:2: gr.texture: cannot find 'nowhere.png' (looked in ., Assets, ../Assets)
gr.texture('nowhere.png')
