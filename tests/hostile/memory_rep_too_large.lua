-- expect: SCRIPT:3: resulting string too large
-- arguments: --script-time 5
local s = ('x'):rep(1 << 62)
