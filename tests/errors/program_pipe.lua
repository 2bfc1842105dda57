-- expect: SCRIPT:2: attempt to call a nil value (field 'popen'); the sandbox has no io.popen (docs/security.md)
io.popen('true')
