-- expect: SCRIPT: the script used up its 0.1 s of processor time (--script-time allows more)
local s = ('x'):rep(200000)
s:find(('x*'):rep(8) .. 'y')
