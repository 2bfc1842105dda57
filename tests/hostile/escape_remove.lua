-- expect: SCRIPT:2: escape_remove.lua: scenes write no files*
assert(os.remove('escape_remove.lua'))
