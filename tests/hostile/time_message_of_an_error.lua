-- expect: SCRIPT*the script used up its 0.1 s of processor time (--script-time allows more)
-- The error that ends the script has a text that is never ready.
error(setmetatable({}, { __tostring = function() while true do end end }))
