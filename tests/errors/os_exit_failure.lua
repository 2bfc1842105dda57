-- expect: SCRIPT:2: os.exit: the script says that it failed
os.exit(3)
