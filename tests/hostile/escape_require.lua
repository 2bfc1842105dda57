-- expect: SCRIPT:3: require: cannot find module 'passwd' (no such file on package.path)
package.path = '/etc/?'
require('passwd')
