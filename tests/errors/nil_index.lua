-- expect: SCRIPT:2: attempt to index a nil value (local 't')
local t; t.x = 1
