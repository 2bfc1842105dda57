-- expect: SCRIPT:2: gr.difresnel_material: material has no index of refraction; give it one with gr.rr_material
gr.difresnel_material(gr.material({1, 1, 1}, {0, 0, 0}, 1))
