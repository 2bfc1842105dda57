-- expect: SCRIPT:2: os.exit: the script says that it failed
local run = coroutine.create(function() os.exit(1) end)
while true do coroutine.resume(run) end
