-- expect: SCRIPT:2: /dev/fd/3: lies outside*
assert(io.open('/dev/fd/3'))
