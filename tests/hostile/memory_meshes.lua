-- expect: *used up its memory of 64 MiB
-- arguments: --script-time 30
local m, n = gr.material({1, 1, 1}, {1, 1, 1}, 1), 0
while true do
    n = n + 1
    local verts = {{0, 0, 0}, {n, 0, 0}, {0, n, 0}}
    for k = 1, 300 do verts[#verts + 1] = {k, n, 1} end
    gr.mesh(m, verts, {{0, 1, 2}})
end
