-- expect: SCRIPT:3: the script printed more than its 1 MiB (--script-output allows more)
io.output(io.stderr)
io.write(('x'):rep(2000000))
