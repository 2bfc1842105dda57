-- expect: SCRIPT:2: gr.sphere: material or name must be a material or a string, not a boolean; with names: gr.sphere{material = ..., centre = ..., radius = ...}
local function f() return gr.sphere(true) end
f()
