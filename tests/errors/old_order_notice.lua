-- expect: SCRIPT: old transform order, because it uses readobj (line 4); set it with --transform-order old or gr.transform_order('old')
-- arguments: --transform-order auto
local scene = gr.node('scene')
scene:add_child(gr.mesh('cow', readobj('cow.obj')))
