-- expect: *used up its memory of 64 MiB*
-- arguments: --script-time 5
local name, count = ('n'):rep(100000), 0
while true do
    count = count + 1
    gr.node(name .. count)
end
