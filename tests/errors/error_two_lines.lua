-- expect: SCRIPT:2: first
error('first\nsecond')
