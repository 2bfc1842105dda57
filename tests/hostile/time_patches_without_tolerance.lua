-- expect: SCRIPT*the script used up its 0.1 s of processor time (--script-time allows more)
-- A curved patch with a tolerance of 1e-300.
local points = {}
for i = 0, 15 do points[#points + 1] = { i % 4, i // 4, i == 4 and 1e9 or 0 } end
while true do pcall(gr.patch, { points = points, tolerance = 1e-300 }) end
