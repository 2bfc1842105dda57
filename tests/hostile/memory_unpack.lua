-- expect: SCRIPT:3: too many results to unpack
-- arguments: --script-time 5
table.unpack({}, 1, 1e8)
