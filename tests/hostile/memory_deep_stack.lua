-- expect: *used up its
-- arguments: --script-time 0.1
local function f(...) return f(1, ...) end
f()
