-- expect: SCRIPT:2: node:set_bump comes with version 0.2 (this is 0.1.0) (node 'ball')
gr.sphere('ball'):set_bump('b.png')
