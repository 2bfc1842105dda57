-- expect: SCRIPT*the script used up its 0.1 s of processor time (--script-time allows more)
-- A table that claims to have 10^9 entries, joined by Lua's own function.
local lies = setmetatable({}, { __len = function() return 1e9 end, __index = function() return 1 end })
while true do pcall(table.concat, lies, 'x') end
