-- expect: SCRIPT:2: gr.mesh: cannot find 'leads_out' (looked in *
gr.mesh('m', 'leads_out')
