-- Scenes name their variables table, math, string ...: gray must not need those globals while a script runs.
local make, light, draw = gr.node, gr.light, gr.render
table = gr.node('table')
math = gr.sphere('math')
string = 'a piece of string'
io, os, debug, coroutine, select, type, error, next, tostring, pcall = nil
pairs_of = pairs
table:add_child(math)
math:scale(1, 2, 3)
table:rotate('x', 90)
local seen = {}
for key in pairs_of({x = 1, y = 2, 7}) do seen[#seen + 1] = key end
if seen[1] ~= 1 or seen[2] ~= 'x' or seen[3] ~= 'y' then make(nil, nil, gr) end
require = nil
draw(table, 'shadowed.png', 8, 8, {0, 0, 10}, {0, 0, -1}, {0, 1, 0}, 50, {0, 0, 0}, {light({0, 0, 9}, {1, 1, 1}, {1, 0, 0})})
