-- expect: SCRIPT:2: require: cannot find module 'nowhere' (no such file on package.path)
require 'nowhere'
