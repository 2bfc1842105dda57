-- expect: SCRIPT:3: warning: gr.mesh: escape_map.mtl:2: the picture '/etc/passwd' is not there (node 'm')
-- status: 0
gr.mesh('m', 'escape_map.obj')
