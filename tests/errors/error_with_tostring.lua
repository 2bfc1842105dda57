-- expect: SCRIPT:2: a lamp of mine
error(setmetatable({}, {__tostring = function() return 'a lamp of mine' end}))
