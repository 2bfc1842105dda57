-- expect: SCRIPT:2: gr.nh_sphere: radius is missing (node 'eye')
gr.nh_sphere('eye', {0, 0, 0})
