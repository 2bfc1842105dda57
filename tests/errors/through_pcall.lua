-- expect: SCRIPT:2: gr.sphere: material or name must be a material or a string, not a boolean; with names: gr.sphere{material = ..., centre = ..., radius = ...}
print(select(2, pcall(gr.sphere, true))); gr.sphere(true)
