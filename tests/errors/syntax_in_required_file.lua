-- expect: lib/syntax.lua:2: unexpected symbol near '='
require 'lib.syntax'
