-- expect: SCRIPT: the script used up its 0.1 s of processor time (--script-time allows more)
local s = ('x'):rep(10000000)
while true do utf8.len(s) end
