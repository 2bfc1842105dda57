-- expect: SCRIPT:2: /proc/self/mem: lies outside*
assert(io.open('/proc/self/mem'))
