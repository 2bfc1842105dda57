-- expect: SCRIPT:3: unexpected symbol near <eof>
local a = {
