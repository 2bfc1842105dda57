-- expect: *used up its 0.1 s
local t = {}
for k = 1, 5000 do t[k] = k % 7 end
while true do pcall(table.sort, t, function() return true end) end
