-- expect: *attempt to load a binary chunk (mode is 't')
assert(loadstring(string.dump(function() end)))
