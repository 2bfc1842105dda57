-- expect: SCRIPT:2: dofile: 'leads_out' lies outside the folders that scenes may read (--allow-read DIR adds one)
dofile('leads_out')
