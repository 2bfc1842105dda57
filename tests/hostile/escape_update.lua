-- expect: SCRIPT:2: escape_update.lua: scenes write no files*
assert(io.open('escape_update.lua', 'r+'))
