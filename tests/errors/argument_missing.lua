-- expect: SCRIPT:2: gr.nh_sphere: radius is missing; the call is gr.nh_sphere(name, centre, radius) (node 'eye')
gr.nh_sphere('eye', {0, 0, 0})
