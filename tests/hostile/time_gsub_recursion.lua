-- expect: *used up its 0.1 s
local function f() return (('x'):gsub('x', f)) end
while true do pcall(f) end
