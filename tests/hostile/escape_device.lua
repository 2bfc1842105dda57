-- expect: SCRIPT:2: /dev/zero: lies outside*
assert(io.open('/dev/zero'))
