module(..., package.seeall)
red = {1, 0, 0}
colours_loaded = true
function mix(t) return math.pow(t, 2) end
assert(_NAME == 'parts.colours' and _M.red == red)
