-- expect: SCRIPT:2: gr.nh_box: size is too small for this corner (node 'box')
gr.nh_box('box', {1e20, 0, 0}, 1)
