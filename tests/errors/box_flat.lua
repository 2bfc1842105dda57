-- expect: SCRIPT:2: gr.nh_box: size must not be 0 (node 'box')
gr.nh_box('box', {0, 0, 0}, 0)
