-- expect: SCRIPT:4: require: cannot find module 'passwd' (no such file on package.path)
-- A script may set the path of modules, but not which files it may read.
package.path = '/etc/?;/etc/?.lua;../../../../../../etc/?'
require 'passwd'
