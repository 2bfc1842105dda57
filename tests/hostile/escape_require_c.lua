-- expect: SCRIPT:3: require: cannot find module 'x' (no such file on package.path)
package.cpath = '/usr/lib/?.so;./?.so'
require('x')
