-- expect: SCRIPT:2: the script used up its 0.1 s of processor time (--script-time allows more)
while true do local _ = os.clock() end
