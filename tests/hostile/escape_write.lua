-- expect: SCRIPT:2: harm.txt: scenes write no files (--allow-write DIR lets them)
assert(io.open('harm.txt', 'w'))
