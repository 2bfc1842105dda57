-- expect: SCRIPT:2: escape_rename.lua: scenes cannot write files*
assert(os.rename('escape_rename.lua', 'harm.lua'))
