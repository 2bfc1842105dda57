-- mesh_tools: the module `meshes` under a second name, for scenes in a folder with another meshes.lua.
-- (A script's folder is searched before the library; modules of the library always find each other.)
-- Example: local meshes = require 'mesh_tools'

return require 'meshes'
