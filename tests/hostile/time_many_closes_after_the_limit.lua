-- expect: *used up its 0.1 s
local meta = {__close = function() while true do end end}
local function deeper(n)
    local x <close> = setmetatable({}, meta)
    if n == 0 then while true do end end
    deeper(n - 1)
end
pcall(deeper, 150)
while true do end
