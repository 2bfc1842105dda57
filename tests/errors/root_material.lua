-- expect: SCRIPT:2: gr.render: node must be a node, not a material; a shape has the material, as in gr.sphere(material)
gr.render(gr.material({1, 1, 1}, {1, 1, 1}, 1), 'no.png', 8, 8, {0, 0, 5}, {0, 0, -1}, {0, 1, 0}, 50, {0, 0, 0}, {})
