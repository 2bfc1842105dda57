-- expect: SCRIPT:2: gr.mesh: *lies outside
gr.mesh('m', '/etc/passwd')
