-- expect: *used up its memory of 64 MiB
-- arguments: --script-time 5
local s = ('x'):rep(1000000):gsub('', ('y'):rep(1000))
