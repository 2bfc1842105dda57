-- expect: *used up its 0.1 s
error(setmetatable({}, {__tostring = function() while true do end end}))
