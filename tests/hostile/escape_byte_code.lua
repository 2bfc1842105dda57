-- expect: *attempt to load a binary chunk (mode is 't')
assert(load(string.dump(function() end), 'x', 'b'))
