-- expect: SCRIPT:2: node:set_bump: a combined solid has no bump map; set those of its operands (node 'lens')
gr.csg_intersection('lens', gr.sphere('a'), gr.sphere('b')):set_bump('cross.png')
