-- expect: SCRIPT:2: dofile: cannot find 'nowhere.lua' (looked in ., Assets, ../Assets)
dofile('nowhere.lua')
