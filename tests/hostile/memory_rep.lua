-- expect: *used up its memory of 64 MiB
-- arguments: --script-time 5
local s = ('x'):rep(1 << 30)
