-- expect: SCRIPT:2: dofile: cannot find 'leads_out' (looked in *
dofile('leads_out')
