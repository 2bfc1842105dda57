-- expect: SCRIPT:2: escape_append.lua: scenes cannot write files*
assert(io.open('escape_append.lua', 'a'))
