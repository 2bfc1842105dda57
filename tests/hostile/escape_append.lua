-- expect: SCRIPT:2: escape_append.lua: scenes write no files*
assert(io.open('escape_append.lua', 'a'))
