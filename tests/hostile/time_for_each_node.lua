-- expect: *used up its 0.1 s
while true do pcall(gr.sphere) end
