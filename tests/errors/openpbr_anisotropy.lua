-- expect: SCRIPT:2: gr.openpbr_material: subsurface_scatter_anisotropy must be > -1 and < 1
gr.openpbr_material{subsurface_weight = 1, subsurface_scatter_anisotropy = 1}
