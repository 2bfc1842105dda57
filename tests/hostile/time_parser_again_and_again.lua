-- expect: SCRIPT*the script used up its 0.1 s of processor time (--script-time allows more)
-- Texts that take the parser a long time and are refused in the end.
local text = 'return ' .. ('a..'):rep(1e5) .. 'a'
while true do pcall(load, text) end
