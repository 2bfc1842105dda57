-- expect: lib/raises.lua:2: gr.nh_sphere: radius must be > 0 (node 'deep')
dofile('lib/raises.lua')
