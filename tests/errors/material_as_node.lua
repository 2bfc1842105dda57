-- expect: SCRIPT:2: node:add_child: node must be a node, not a material; a shape has the material, as in gr.sphere(material) (node 'n')
gr.node('n'):add_child(gr.material({1, 1, 1}, {0, 0, 0}, 1))
