-- expect: *used up its memory of 64 MiB
-- arguments: --script-time 20
load(function() return 'x = 1 ' end)
