-- expect: *used up its memory of 64 MiB
-- arguments: --script-time 30
local t = {}
for k = 1, 1e9 do t[k] = 'k' .. k end
