-- expect: *
table.foreachi(setmetatable({}, {__len = function() return 1 << 60 end, __index = type}), print)
