-- expect: SCRIPT:2: *may not be read
assert(io.open('leads_up/etc/passwd'))
