-- expect: SCRIPT:2: unexpected symbol near '='
local a = = 1
