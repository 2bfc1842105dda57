-- expect: SCRIPT:2: gr.material: ior is missing: refraction needs an index of refraction
gr.material{kd = {1, 1, 1}, refract = 0.5}
