-- expect: *used up its memory of 64 MiB
-- arguments: --script-time 5
while true do coroutine.resume(coroutine.create(function() return ('x'):rep(1 << 30) end)) end
