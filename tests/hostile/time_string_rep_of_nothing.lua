-- expect: SCRIPT: the script used up its 0.1 s of processor time (--script-time allows more)
string.rep('', 1 << 60)
