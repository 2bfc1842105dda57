-- expect: SCRIPT:2: leads_out: cannot be read by scenes, or is not a regular file
assert(io.open('leads_out'))
