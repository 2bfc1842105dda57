-- expect: SCRIPT: the script used up its 0.1 s of processor time (--script-time allows more)
table.move({}, 1, 1 << 60, 2)
