-- expect:
-- status: 0
-- arguments: -q
for name in pairs(debug) do assert(name == 'traceback' or name == 'getinfo', name) end
local info = debug.getinfo(1, 'SlnfutL')
for name in pairs(info) do assert(name == 'source' or name == 'short_src' or name == 'currentline', name) end
assert(info.currentline == 5 and info.source:match('escape_debug'))
assert(debug.getinfo(print).currentline == -1 and debug.getinfo(1000) == nil)
assert(package.loaded.debug == debug and require('debug') == debug)
