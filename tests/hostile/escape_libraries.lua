-- expect:
-- status: 0
-- arguments: --script-time 5
for _, name in ipairs {'io', 'os', 'package', 'debug', 'string'} do assert(package.loaded[name] == _G[name]) end
assert(package.loaded._G == _G and #package.searchers == 2 and next(package.preload) == nil)
assert(rawget(getmetatable(''), '__index') == string)
