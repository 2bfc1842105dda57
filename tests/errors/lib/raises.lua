local function inner()
    gr.nh_sphere('deep', {0, 0, 0}, -1)
end
inner()
