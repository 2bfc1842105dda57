-- expect: SCRIPT:2: the lamp is missing
error('the lamp is missing')
