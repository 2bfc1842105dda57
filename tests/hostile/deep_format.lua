-- expect: SCRIPT:2: *
string.format('%99999d', 1)
