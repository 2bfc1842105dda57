-- expect: SCRIPT:2: gr.openpbr_material: thin_film_weight is not implemented
gr.openpbr_material{base_color = {1, 1, 1}, thin_film_weight = 0.5}
