-- expect: *printed more than its 1 MiB
while true do io.stdout:write(('x'):rep(1000)) end
