-- mesh_tools: the module `meshes` under a second name, for scenes that stand beside a file meshes.lua of their own.
-- (A script's folder is searched before the library; between our modules ours are always found.)
-- Example: local meshes = require 'mesh_tools'

return require 'meshes'
