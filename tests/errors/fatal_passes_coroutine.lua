-- expect: SCRIPT:2: os.exit: the script reports a failure
local run = coroutine.create(function() os.exit(1) end)
while true do coroutine.resume(run) end
