-- expect: SCRIPT:2: dofile: *lies outside
dofile('/etc/passwd')
