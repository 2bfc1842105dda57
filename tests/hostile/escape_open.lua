-- expect: SCRIPT:2: /etc/passwd: lies outside the folders that scenes may read (--allow-read DIR adds one)
assert(io.open('/etc/passwd'))
