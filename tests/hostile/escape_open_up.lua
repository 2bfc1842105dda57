-- expect: SCRIPT:2: *lies outside
assert(io.open(('../'):rep(30) .. 'etc/passwd'))
