-- expect: SCRIPT:2: os.exit: the script reports a failure
os.exit(3)
