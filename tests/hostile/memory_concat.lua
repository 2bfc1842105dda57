-- expect: *used up its memory of 64 MiB
-- arguments: --script-time 5
local t = {}
local s = ('x'):rep(1000000)
for k = 1, 1000 do t[k] = s end
t = table.concat(t)
