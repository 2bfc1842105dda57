-- expect: SCRIPT:2: /etc/passwd: lies outside*
io.input('/etc/passwd')
