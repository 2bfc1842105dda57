-- expect: SCRIPT:3: gr.instances: at[2] has 2 numbers, not 3 as those before (node 'rocks')
local ball = gr.sphere('ball')
gr.instances{name = 'rocks', of = ball, at = {{1, 0, 0}, {5, 0}}}
