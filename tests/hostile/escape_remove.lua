-- expect: SCRIPT:2: escape_remove.lua: scenes cannot write files*
assert(os.remove('escape_remove.lua'))
