-- expect: SCRIPT:2: unexpected symbol near '='; = gives a value, == compares two
local a = = 1
