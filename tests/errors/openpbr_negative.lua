-- expect: SCRIPT:2: gr.openpbr_material: coat_roughness must be between 0 and 1
gr.openpbr_material{base_color = {1, 1, 1}, coat_roughness = -0.1}
