-- expect: *used up its 0.1 s
while true do xpcall(error, function() error('again') end) end
