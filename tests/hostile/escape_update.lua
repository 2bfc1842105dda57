-- expect: SCRIPT:2: escape_update.lua: scenes cannot write files*
assert(io.open('escape_update.lua', 'r+'))
