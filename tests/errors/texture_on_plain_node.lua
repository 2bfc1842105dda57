-- expect: SCRIPT:2: node:set_texture: a plain node has no texture (node 'n')
gr.node('n'):set_texture('lib/broken.png')
