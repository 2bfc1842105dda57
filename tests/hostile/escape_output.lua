-- expect: SCRIPT:2: harm.txt: scenes write no files*
io.output('harm.txt')
