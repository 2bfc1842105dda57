-- expect: SCRIPT:3: gr.union: 'c' is clipped, cut open without caps, so it has no inside; intersect it instead (node 'u')
local cut = gr.clipped_by('c', gr.sphere('s'), gr.cube('by'))
gr.union('u', gr.sphere('t'), cut)
