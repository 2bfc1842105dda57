-- expect:
-- status: 0
assert(io.read() == nil and io.read('a') == '')
