-- expect: SCRIPT:3: gr.render: lights[2] is nil
local l = {gr.light({0, 0, 0}, {1, 1, 1})}; l[3] = l[1]
gr.render(gr.node('n'), 'no.png', 8, 8, {0, 0, 5}, {0, 0, -1}, {0, 1, 0}, 50, {0, 0, 0}, l)
