-- expect: *used up its
load(function() return 'x = 1 ' end)
