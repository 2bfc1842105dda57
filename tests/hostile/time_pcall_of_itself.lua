-- expect: SCRIPT*the script used up its 0.1 s of processor time (--script-time allows more)
-- Nested protected calls until each reaches the limit of the C stack.
local function deeper(...) return pcall(deeper, ...) end
while true do deeper(1, 2, 3) end
