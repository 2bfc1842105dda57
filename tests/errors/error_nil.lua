-- expect: SCRIPT:2: the script raised nil
error()
