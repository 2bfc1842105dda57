-- expect: SCRIPT*the script used up its 0.1 s of processor time (--script-time allows more)
-- Calls that protect themselves, one inside the other, until the C stack's limit is met in each.
local function deeper(...) return pcall(deeper, ...) end
while true do deeper(1, 2, 3) end
