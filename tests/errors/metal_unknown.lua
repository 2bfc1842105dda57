-- expect: SCRIPT:2: gr.metal_material: metal must be 'aluminium', 'brass', 'chromium', 'cobalt', 'copper', 'gold', 'iron', 'manganese', 'nickel', 'palladium', 'platinum', 'silver', 'titanium', 'tungsten', 'vanadium' or 'zinc', not 'gould'; did you mean 'gold'?
gr.metal_material{metal = 'gould'}
