-- expect: SCRIPT:4: '__index' chain too long; possible loop
local t = {}
setmetatable(t, {__index = t})
local _ = t.x
