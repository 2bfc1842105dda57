-- expect: SCRIPT:4: require: cannot find module 'passwd' (no such file on package.path)
-- The path of modules is the script's, what may be read is not.
package.path = '/etc/?;/etc/?.lua;../../../../../../etc/?'
require 'passwd'
