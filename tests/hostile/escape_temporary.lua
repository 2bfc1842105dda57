-- expect:
-- status: 0
assert(os.tmpname == nil and io.tmpfile == nil)
