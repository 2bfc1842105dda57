-- expect: SCRIPT:3: warning: gr.mesh: escape_library.obj:1: the material library '/etc/passwd' is not there (node 'm')
-- status: 0
gr.mesh('m', 'escape_library.obj')
