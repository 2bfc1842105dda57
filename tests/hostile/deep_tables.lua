-- expect: *
local t = {}
for _ = 1, 100000 do t = {t} end
gr.light(t, t, t)
