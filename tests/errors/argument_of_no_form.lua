-- expect: SCRIPT:2: gr.sphere: material or name must be a material or a string, not a boolean
gr.sphere(true)
