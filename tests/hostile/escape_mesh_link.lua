-- expect: SCRIPT:2: gr.mesh: 'leads_out' lies outside the folders that scenes may read (--allow-read DIR adds one)*
gr.mesh('m', 'leads_out')
