-- expect: SCRIPT:2: node:set_bump: a plain node has no bump map (node 'group')
gr.node('group'):set_bump('cross.png')
