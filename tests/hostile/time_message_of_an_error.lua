-- expect: SCRIPT*the script used up its 0.1 s of processor time (--script-time allows more)
-- The text of the error that ends the script takes forever to make.
error(setmetatable({}, { __tostring = function() while true do end end }))
