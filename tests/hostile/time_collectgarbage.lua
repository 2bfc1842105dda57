-- expect: *used up its 0.1 s
local t = {}
for k = 1, 200000 do t[k] = {} end
while true do collectgarbage() end
