-- expect: SCRIPT:2: harm.txt: scenes cannot write files*
io.output('harm.txt')
