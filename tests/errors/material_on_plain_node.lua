-- expect: SCRIPT:2: node:set_material: a plain node has no material (node 'n')
gr.node('n'):set_material(gr.material({1, 1, 1}, {0, 0, 0}, 1))
