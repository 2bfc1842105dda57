-- expect: SCRIPT:2: gr.sphere: material or name is missing
gr.sphere()
