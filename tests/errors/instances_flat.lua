-- expect: SCRIPT:3: gr.instances: at[2] is a singular matrix: it has no inverse (node 'rocks')
local ball = gr.sphere('ball')
gr.instances{name = 'rocks', of = ball, at = {{1, 0, 0, 5, 0, 1, 0, 6, 0, 0, 1, 7}, {1, 0, 0, 5, 0, 1, 0, 6, 0, 0, 0, 7}}}
