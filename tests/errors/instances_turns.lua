-- expect: SCRIPT:3: gr.instances: turn has 3 numbers for 2 places (node 'rocks')
local ball = gr.sphere('ball')
gr.instances{name = 'rocks', of = ball, at = {{1, 0, 0}, {5, 0, 0}}, turn = {1, 2, 3}}
