-- expect: *attempt to load a binary chunk (mode is 't')
local code = string.dump(function() end)
assert(load(function() local part = code code = nil return part end, 'x', 'bt'))
