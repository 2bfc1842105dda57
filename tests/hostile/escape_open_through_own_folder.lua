-- expect: SCRIPT:2: *lies outside
assert(io.open('../hostile/../../../../../../../../../../../../../etc/passwd'))
