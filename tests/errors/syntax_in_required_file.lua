-- expect: lib/syntax.lua:2: unexpected symbol near '='; = gives a value, == compares two
require 'lib.syntax'
