-- expect:
-- status: 0
assert(os.execute == nil and io.popen == nil and package.loadlib == nil and os.setlocale == nil)
