-- expect: SCRIPT: the script used up its 0.1 s of processor time (--script-time allows more)
local s = ('('):rep(1000000)
s:find('%b()')
s:find('%b()%b()')
