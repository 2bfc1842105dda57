-- expect: SCRIPT:2: leads_out: may not be read by scenes, or is no regular file
assert(io.open('leads_out'))
