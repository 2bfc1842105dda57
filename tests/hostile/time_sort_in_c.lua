-- expect: SCRIPT: the script used up its 0.1 s of processor time (--script-time allows more)
local t = {}
for k = 1, 1000000 do t[k] = 0 end
while true do table.sort(t) end
