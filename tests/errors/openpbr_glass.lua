-- expect: SCRIPT:2: gr.openpbr_material: glass has an index and a dispersion of its own: specular_ior is not needed
gr.openpbr_material{transmission_weight = 1, glass = 'F2', specular_ior = 1.6}
