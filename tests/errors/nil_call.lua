-- expect: SCRIPT:2: attempt to call a nil value (field 'x')
local t = {}; t.x()
