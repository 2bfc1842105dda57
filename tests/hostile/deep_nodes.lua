-- expect:
-- status: 0
-- arguments: --script-time 5
local n = gr.node('n')
for _ = 1, 20000 do local p = gr.node('p') p:add_child(n) n = p end
