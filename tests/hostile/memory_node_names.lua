-- expect: *used up its memory of 64 MiB
-- arguments: --script-time 5
local name = ('n'):rep(100000)
while true do gr.node(name) end
