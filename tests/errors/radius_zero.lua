-- expect: SCRIPT:2: gr.nh_sphere: radius must be > 0 (node 'eye')
gr.nh_sphere('eye', {0, 0, 0}, 0)
