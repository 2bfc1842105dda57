-- expect: *used up its memory of 64 MiB
-- arguments: --script-time 5
local s = 'x'
while true do s = s .. s end
