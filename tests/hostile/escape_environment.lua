-- expect:
-- status: 0
assert(os.getenv('HOME') == nil and os.getenv('PATH') == nil)
