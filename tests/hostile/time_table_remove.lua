-- expect: SCRIPT: the script used up its 0.1 s of processor time (--script-time allows more)
table.remove(setmetatable({}, {__len = function() return 1 << 60 end}), 1)
