-- expect: SCRIPT:2: harm.txt: scenes cannot write files (--allow-write DIR allows it)
assert(io.open('harm.txt', 'w'))
