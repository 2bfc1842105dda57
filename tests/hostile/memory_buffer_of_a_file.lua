-- expect: *used up its memory of 64 MiB
-- arguments: --script-time 5
io.open('memory_table.lua'):read(1 << 30)
