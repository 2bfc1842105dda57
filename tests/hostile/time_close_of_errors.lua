-- expect: SCRIPT*the script used up its 0.1 s of processor time (--script-time allows more)
-- Every error closes a variable whose __close would never end.
local endless = setmetatable({}, { __close = function() while true do end end })
local function raise()
    local closed <close> = endless
    error('x')
end
while true do pcall(raise) end
