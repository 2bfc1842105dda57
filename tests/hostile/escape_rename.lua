-- expect: SCRIPT:2: escape_rename.lua: scenes write no files*
assert(os.rename('escape_rename.lua', 'harm.lua'))
