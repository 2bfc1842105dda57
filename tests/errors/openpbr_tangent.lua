-- expect: SCRIPT:2: gr.openpbr_material: geometry_tangent has length 0
gr.openpbr_material{geometry_tangent = {0, 0, 0}}
