-- expect: SCRIPT:2: gr.openpbr_material: base_color[2] must not be NaN (not a number)
gr.openpbr_material{base_color = {1, 0 / 0, 1}}
