-- expect: SCRIPT:2: attempt to call a nil value (field 'popen')
io.popen('true')
