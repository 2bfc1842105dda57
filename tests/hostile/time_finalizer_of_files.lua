-- expect:
-- status: 0
assert(getmetatable(io.stdout) == 'file')
assert(not pcall(setmetatable, io.stdout, {}))
