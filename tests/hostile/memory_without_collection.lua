-- expect: *used up its
-- arguments: --script-time 0.3
collectgarbage('stop')
while true do local _ = {} end
