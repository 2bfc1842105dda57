-- expect: SCRIPT:3: the script used up its 0.1 s of processor time (--script-time allows more)
local t = {3, 2, 1}
table.sort(t, function() while true do end end)
