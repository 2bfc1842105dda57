-- expect: *used up its memory of 64 MiB
-- arguments: --script-time 5
local t = {}
while true do t[#t + 1] = coroutine.wrap(print) end
