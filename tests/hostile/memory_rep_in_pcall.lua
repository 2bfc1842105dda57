-- expect: *used up its memory of 64 MiB
-- arguments: --script-time 5
while true do pcall(string.rep, 'x', 1 << 30) end
