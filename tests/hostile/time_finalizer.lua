-- expect:
-- status: 0
for _ = 1, 100 do setmetatable({}, {__gc = function() while true do end end}) end
collectgarbage()
