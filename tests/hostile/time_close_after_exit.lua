-- expect:
-- status: 0
local x <close> = setmetatable({}, {__close = function() while true do end end})
os.exit(true)
