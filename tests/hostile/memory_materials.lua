-- expect: *used up its memory of 64 MiB
-- arguments: --script-time 5
while true do gr.material({1, 1, 1}, {1, 1, 1}, 1) end
