-- expect: SCRIPT:2: gr.openpbr_material: geometry_coat_normal is not implemented
gr.openpbr_material{base_color = {1, 1, 1}, geometry_coat_normal = "x.png"}
