-- expect: SCRIPT:2: attempt to call a nil value (field 'execute'); the sandbox has no os.execute (docs/security.md)
os.execute('true')
