-- expect: *used up its 0.1 s
assert(collectgarbage('generational') == 'incremental')
while true do end
