-- expect: SCRIPT:2: gr.metal_material: tangent has length 0
gr.metal_material{metal = 'gold', anisotropy = .5, tangent = {0, 0, 0}}
