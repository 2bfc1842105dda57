-- expect: SCRIPT:2: the script printed more than its 1 MiB (--script-output allows more)
while true do pcall(print, ('x'):rep(1000)) end
