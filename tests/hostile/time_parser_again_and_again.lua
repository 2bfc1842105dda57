-- expect: SCRIPT*the script used up its 0.1 s of processor time (--script-time allows more)
-- Texts that the parser works on for long, and refuses in the end.
local text = 'return ' .. ('a..'):rep(1e5) .. 'a'
while true do pcall(load, text) end
