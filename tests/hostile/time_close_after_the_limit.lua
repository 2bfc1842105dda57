-- expect: SCRIPT:3: the script used up its 0.1 s of processor time (--script-time allows more)
local x <close> = setmetatable({}, {__close = function() while true do end end})
while true do end
