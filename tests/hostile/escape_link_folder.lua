-- expect: SCRIPT:2: *cannot be read by scenes
assert(io.open('leads_up/etc/passwd'))
