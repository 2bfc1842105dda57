-- expect: *overflow
assert(load(('('):rep(1000000)))
