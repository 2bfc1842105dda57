-- expect:
-- status: 0
assert(package.searchpath('passwd', '/etc/?') == nil and package.loadlib == nil)
