-- expect: *
-- arguments: --script-time 5
string.pack('s4', ('x'):rep(40 << 20))
