-- expect:
-- status: 0
local meta = {}
local t = setmetatable({}, meta)
meta.__gc = function() while true do end end
t = setmetatable({}, meta)
t = nil
collectgarbage()
