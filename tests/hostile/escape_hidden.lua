-- expect:
-- status: 0
assert(io.open('../../.gitignore') == nil and io.open('.hidden/x') == nil)
