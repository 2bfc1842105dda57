-- expect: SCRIPT:2: gr.material: glass has an index of its own: ior is not needed
gr.material{kd = {0, 0, 0}, refract = 1, glass = 'F2', ior = 1.6}
