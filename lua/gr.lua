---@meta

-- The gr functions for editors that understand LuaLS annotations. Written by `gray --annotations` from
-- the table in src/script/table.c; a test checks that it is current.

---@alias gr.triple number[] three numbers: a point, a direction, a colour
---@class gr.material
---@class gr.light
---@class gr.texture
---@class gr.fog
---@class gr.sky
---@class gr.node
local node = {}

gr = {}

---The version of the renderer.
gr.version = ''

---@class gr.node.fields
---@field name? string name (a string; default 'node'): Name of the node, for messages.
---@field children? gr.node[] children (a table of nodes; default {}): Nodes placed under this one.

---A node that holds others and carries a transform.
---@param name? string name (a string; default 'node'): Name of the node, for messages.
---@return gr.node
---@overload fun(fields: gr.node.fields): gr.node
function gr.node(name) end

---@class gr.instances.fields
---@field name? string name (a string; default 'instances'): Name of the node, for messages.
---@field of gr.node of (a node): What stands in all the places.
---@field at number[][] at (a table of tables of numbers): The places, {x, y, z}, or the first three rows of matrices, 12 numbers each.
---@field turn? number|number[] turn (a number or a table of numbers, in degrees; default 0): Turn about axis before it is moved to its place, for each or one for all.
---@field axis? 'x'|'y'|'z' axis ('x', 'y' or 'z'; default 'y'): Axis of turn.
---@field size? number|number[] size (a number or a table of numbers, > 0; default 1): Factor by which it is scaled first, for each or one for all.

---A node that stands in many places, which cost a tenth of a node for each.
---@param of gr.node of (a node): What stands in all the places.
---@param at number[][] at (a table of tables of numbers): The places, {x, y, z}, or the first three rows of matrices, 12 numbers each.
---@return gr.node
---@overload fun(fields: gr.instances.fields): gr.node
function gr.instances(of, at) end

---@class gr.joint.fields
---@field name? string name (a string; default 'joint'): Name of the node, for messages.
---@field x gr.triple x (a table of 3 numbers, in degrees): Smallest, initial and largest angle about x; drawn at the initial one.
---@field y gr.triple y (a table of 3 numbers, in degrees): The same about y.
---@field children? gr.node[] children (a table of nodes; default {}): Nodes placed under this one.

---A node with angles about x and y between limits.
---@param name string name (a string; default 'joint'): Name of the node, for messages.
---@param x gr.triple x (a table of 3 numbers, in degrees): Smallest, initial and largest angle about x; drawn at the initial one.
---@param y gr.triple y (a table of 3 numbers, in degrees): The same about y.
---@return gr.node
---@overload fun(fields: gr.joint.fields): gr.node
function gr.joint(name, x, y) end

---@class gr.sphere.fields
---@field name? string name (a string; default 'sphere'): Name of the node, for messages.
---@field material? gr.material material (a material; default plain gray): What its surface looks like.
---@field centre? gr.triple centre (a point {x, y, z}; default {0, 0, 0}): Centre.
---@field radius? number radius (a number, > 0; default 1): Radius.

---A sphere; of radius 1 at the origin if nothing else is said.
---@param material gr.material material (a material; default plain gray): What its surface looks like.
---@return gr.node
---@overload fun(name: string): gr.node
---@overload fun(fields: gr.sphere.fields): gr.node
function gr.sphere(material) end

---@class gr.cube.fields
---@field name? string name (a string; default 'cube'): Name of the node, for messages.
---@field material? gr.material material (a material; default plain gray): What its surface looks like.
---@field corner? gr.triple corner (a point {x, y, z}; default {0, 0, 0}): The corner with the smallest coordinates.
---@field size? number|gr.triple size (a number or a table of 3 numbers, not 0; default 1): Length of the edges, one number or three; a negative one reaches the other way.

---A cube; from (0,0,0) to (1,1,1) if nothing else is said.
---@param material gr.material material (a material; default plain gray): What its surface looks like.
---@return gr.node
---@overload fun(name: string): gr.node
---@overload fun(fields: gr.cube.fields): gr.node
function gr.cube(material) end

---@class gr.nh_sphere.fields
---@field name? string name (a string; default 'sphere'): Name of the node, for messages.
---@field material? gr.material material (a material; default plain gray): What its surface looks like.
---@field centre? gr.triple centre (a point {x, y, z}; default {0, 0, 0}): Centre.
---@field radius? number radius (a number, > 0; default 1): Radius.

---A sphere at a place.
---@param name string name (a string; default 'sphere'): Name of the node, for messages.
---@param centre gr.triple centre (a point {x, y, z}; default {0, 0, 0}): Centre.
---@param radius number radius (a number, > 0; default 1): Radius.
---@return gr.node
---@overload fun(material: gr.material, centre: gr.triple, radius: number): gr.node
---@overload fun(fields: gr.nh_sphere.fields): gr.node
function gr.nh_sphere(name, centre, radius) end

---@class gr.nh_box.fields
---@field name? string name (a string; default 'cube'): Name of the node, for messages.
---@field material? gr.material material (a material; default plain gray): What its surface looks like.
---@field corner? gr.triple corner (a point {x, y, z}; default {0, 0, 0}): The corner with the smallest coordinates.
---@field size? number|gr.triple size (a number or a table of 3 numbers, not 0; default 1): Length of the edges, one number or three; a negative one reaches the other way.

---A cube at a place.
---@param name string name (a string; default 'cube'): Name of the node, for messages.
---@param corner gr.triple corner (a point {x, y, z}; default {0, 0, 0}): The corner with the smallest coordinates.
---@param size number|gr.triple size (a number or a table of 3 numbers, not 0; default 1): Length of the edges, one number or three; a negative one reaches the other way.
---@return gr.node
---@overload fun(material: gr.material, corner: gr.triple, size: number|gr.triple): gr.node
---@overload fun(fields: gr.nh_box.fields): gr.node
function gr.nh_box(name, corner, size) end

---@class gr.mesh.fields
---@field name? string name (a string; default 'mesh'): Name of the node, for messages.
---@field material? gr.material material (a material; default plain gray): What its surface looks like.
---@field file? string file (the name of a file; optional): An OBJ, PLY, STL, glTF or GLB file, instead of verts and faces.
---@field verts? gr.triple[] verts (a table of points {x, y, z}; optional): The vertices.
---@field normals? gr.triple[] normals (a table of points {x, y, z}; default none: flat): Vertex normals, of any length.
---@field faces? integer[][] faces (a table of tuples of indices; optional): Polygons: tuples of 0-based indices into verts.
---@field face_normals? integer[][] face_normals (a table of tuples of indices; default faces): For each face a tuple of 0-based indices into normals.
---@field uvs? number[][] uvs (a table of pairs {u, v}; default none): Places on an image, {u, v}; v counts from below.
---@field face_uvs? integer[][] face_uvs (a table of tuples of indices; default faces): For each face a tuple of 0-based indices into uvs.
---@field smooth? number smooth (a number, 0 to 180, in degrees; default as given): Faces that meet at less than this angle are one smooth surface; 0: all are flat.
---@field weld? boolean weld (true or false; default false): Whether vertices in one place become one.
---@field flip? boolean flip (true or false; default false): Whether the faces are turned round.
---@field cull? 'none'|'back'|'front' cull ('none'|'back'|'front'; default 'none'): Which faces no ray meets: those seen from behind, or from the front.
---@field materials? table<string|integer, gr.material> materials (a table of materials; default the file's): Materials by the names that the file gives its parts, or with face_materials a list.
---@field face_materials? number|number[] face_materials (a number or a table of numbers; default material for all): With faces: for each the number of its entry in materials, from 1.

---A mesh of polygons, flat or with vertex normals.
---@param material gr.material material (a material; default plain gray): What its surface looks like.
---@param verts gr.triple[] verts (a table of points {x, y, z}; optional): The vertices.
---@param faces integer[][] faces (a table of tuples of indices; optional): Polygons: tuples of 0-based indices into verts.
---@return gr.node
---@overload fun(name: string, file: string): gr.node
---@overload fun(name: string, verts: gr.triple[], faces: integer[][]): gr.node
---@overload fun(material: gr.material, file: string): gr.node
---@overload fun(fields: gr.mesh.fields): gr.node
function gr.mesh(material, verts, faces) end

---@class gr.fast_mesh.fields
---@field name? string name (a string; default 'mesh'): Name of the node, for messages.
---@field material? gr.material material (a material; default plain gray): What its surface looks like.
---@field file? string file (the name of a file; optional): An OBJ, PLY, STL, glTF or GLB file, instead of verts and faces.
---@field verts? gr.triple[] verts (a table of points {x, y, z}; optional): The vertices.
---@field normals? gr.triple[] normals (a table of points {x, y, z}; default none: flat): Vertex normals, of any length.
---@field faces? integer[][] faces (a table of tuples of indices; optional): Polygons: tuples of 0-based indices into verts.
---@field face_normals? integer[][] face_normals (a table of tuples of indices; default faces): For each face a tuple of 0-based indices into normals.
---@field uvs? number[][] uvs (a table of pairs {u, v}; default none): Places on an image, {u, v}; v counts from below.
---@field face_uvs? integer[][] face_uvs (a table of tuples of indices; default faces): For each face a tuple of 0-based indices into uvs.
---@field smooth? number smooth (a number, 0 to 180, in degrees; default as given): Faces that meet at less than this angle are one smooth surface; 0: all are flat.
---@field weld? boolean weld (true or false; default false): Whether vertices in one place become one.
---@field flip? boolean flip (true or false; default false): Whether the faces are turned round.
---@field cull? 'none'|'back'|'front' cull ('none'|'back'|'front'; default 'none'): Which faces no ray meets: those seen from behind, or from the front.
---@field materials? table<string|integer, gr.material> materials (a table of materials; default the file's): Materials by the names that the file gives its parts, or with face_materials a list.
---@field face_materials? number|number[] face_materials (a number or a table of numbers; default material for all): With faces: for each the number of its entry in materials, from 1.

---The same as gr.mesh: every mesh is fast.
---@param material gr.material material (a material; default plain gray): What its surface looks like.
---@param verts gr.triple[] verts (a table of points {x, y, z}; optional): The vertices.
---@param faces integer[][] faces (a table of tuples of indices; optional): Polygons: tuples of 0-based indices into verts.
---@return gr.node
---@overload fun(name: string, verts: gr.triple[], faces: integer[][]): gr.node
---@overload fun(fields: gr.fast_mesh.fields): gr.node
function gr.fast_mesh(material, verts, faces) end

---@class gr.vn_mesh.fields
---@field name? string name (a string; default 'mesh'): Name of the node, for messages.
---@field material? gr.material material (a material; default plain gray): What its surface looks like.
---@field file? string file (the name of a file; optional): An OBJ, PLY, STL, glTF or GLB file, instead of verts and faces.
---@field verts? gr.triple[] verts (a table of points {x, y, z}; optional): The vertices.
---@field normals? gr.triple[] normals (a table of points {x, y, z}; default none: flat): Vertex normals, of any length.
---@field faces? integer[][] faces (a table of tuples of indices; optional): Polygons: tuples of 0-based indices into verts.
---@field face_normals? integer[][] face_normals (a table of tuples of indices; default faces): For each face a tuple of 0-based indices into normals.
---@field uvs? number[][] uvs (a table of pairs {u, v}; default none): Places on an image, {u, v}; v counts from below.
---@field face_uvs? integer[][] face_uvs (a table of tuples of indices; default faces): For each face a tuple of 0-based indices into uvs.
---@field smooth? number smooth (a number, 0 to 180, in degrees; default as given): Faces that meet at less than this angle are one smooth surface; 0: all are flat.
---@field weld? boolean weld (true or false; default false): Whether vertices in one place become one.
---@field flip? boolean flip (true or false; default false): Whether the faces are turned round.
---@field cull? 'none'|'back'|'front' cull ('none'|'back'|'front'; default 'none'): Which faces no ray meets: those seen from behind, or from the front.
---@field materials? table<string|integer, gr.material> materials (a table of materials; default the file's): Materials by the names that the file gives its parts, or with face_materials a list.
---@field face_materials? number|number[] face_materials (a number or a table of numbers; default material for all): With faces: for each the number of its entry in materials, from 1.

---A mesh with vertex normals.
---@param material gr.material material (a material; default plain gray): What its surface looks like.
---@param verts gr.triple[] verts (a table of points {x, y, z}; optional): The vertices.
---@param normals gr.triple[] normals (a table of points {x, y, z}; default none: flat): Vertex normals, of any length.
---@param faces integer[][] faces (a table of tuples of indices; optional): Polygons: tuples of 0-based indices into verts.
---@param face_normals integer[][] face_normals (a table of tuples of indices; default faces): For each face a tuple of 0-based indices into normals.
---@return gr.node
---@overload fun(name: string, verts: gr.triple[], normals: gr.triple[], faces: integer[][], face_normals: integer[][]): gr.node
---@overload fun(fields: gr.vn_mesh.fields): gr.node
function gr.vn_mesh(material, verts, normals, faces, face_normals) end

---@class gr.fast_vn_mesh.fields
---@field name? string name (a string; default 'mesh'): Name of the node, for messages.
---@field material? gr.material material (a material; default plain gray): What its surface looks like.
---@field file? string file (the name of a file; optional): An OBJ, PLY, STL, glTF or GLB file, instead of verts and faces.
---@field verts? gr.triple[] verts (a table of points {x, y, z}; optional): The vertices.
---@field normals? gr.triple[] normals (a table of points {x, y, z}; default none: flat): Vertex normals, of any length.
---@field faces? integer[][] faces (a table of tuples of indices; optional): Polygons: tuples of 0-based indices into verts.
---@field face_normals? integer[][] face_normals (a table of tuples of indices; default faces): For each face a tuple of 0-based indices into normals.
---@field uvs? number[][] uvs (a table of pairs {u, v}; default none): Places on an image, {u, v}; v counts from below.
---@field face_uvs? integer[][] face_uvs (a table of tuples of indices; default faces): For each face a tuple of 0-based indices into uvs.
---@field smooth? number smooth (a number, 0 to 180, in degrees; default as given): Faces that meet at less than this angle are one smooth surface; 0: all are flat.
---@field weld? boolean weld (true or false; default false): Whether vertices in one place become one.
---@field flip? boolean flip (true or false; default false): Whether the faces are turned round.
---@field cull? 'none'|'back'|'front' cull ('none'|'back'|'front'; default 'none'): Which faces no ray meets: those seen from behind, or from the front.
---@field materials? table<string|integer, gr.material> materials (a table of materials; default the file's): Materials by the names that the file gives its parts, or with face_materials a list.
---@field face_materials? number|number[] face_materials (a number or a table of numbers; default material for all): With faces: for each the number of its entry in materials, from 1.

---The same as gr.vn_mesh.
---@param material gr.material material (a material; default plain gray): What its surface looks like.
---@param verts gr.triple[] verts (a table of points {x, y, z}; optional): The vertices.
---@param normals gr.triple[] normals (a table of points {x, y, z}; default none: flat): Vertex normals, of any length.
---@param faces integer[][] faces (a table of tuples of indices; optional): Polygons: tuples of 0-based indices into verts.
---@param face_normals integer[][] face_normals (a table of tuples of indices; default faces): For each face a tuple of 0-based indices into normals.
---@return gr.node
---@overload fun(name: string, verts: gr.triple[], normals: gr.triple[], faces: integer[][], face_normals: integer[][]): gr.node
---@overload fun(fields: gr.fast_vn_mesh.fields): gr.node
function gr.fast_vn_mesh(material, verts, normals, faces, face_normals) end

---@class gr.geometry.fields
---@field name? string name (a string; default 'geometry'): Name of the node, for messages.
---@field primitive gr.node primitive (a node): A primitive, for instance gr.sphere(mat).
---@field material? gr.material material (a material; default the primitive's): What its surface looks like.

---A node with the shape and look of a primitive.
---@param name string name (a string; default 'geometry'): Name of the node, for messages.
---@param primitive gr.node primitive (a node): A primitive, for instance gr.sphere(mat).
---@return gr.node
---@overload fun(fields: gr.geometry.fields): gr.node
function gr.geometry(name, primitive) end

---@class gr.csg_union.fields
---@field name? string name (a string; default 'csg'): Name of the node, for messages.
---@field a gr.node a (a node): A closed solid; a group counts as the union of what is under it.
---@field b gr.node b (a node): The other one.
---@field operands? gr.node[] operands (a table of nodes; optional): Any number of solids: as further arguments, as a list, or without names in the table, with or without a and b before them.

---The solid of what is in any of the operands; it has no walls inside.
---@param name string name (a string; default 'csg'): Name of the node, for messages.
---@param a gr.node a (a node): A closed solid; a group counts as the union of what is under it.
---@param b gr.node b (a node): The other one.
---@param ... gr.node
---@return gr.node
---@overload fun(a: gr.node, b: gr.node, ...: gr.node): gr.node
---@overload fun(fields: gr.csg_union.fields): gr.node
function gr.csg_union(name, a, b, ...) end

---@class gr.csg_difference.fields
---@field name? string name (a string; default 'csg'): Name of the node, for messages.
---@field a gr.node a (a node): A closed solid; a group counts as the union of what is under it.
---@field b gr.node b (a node): The other one.
---@field operands? gr.node[] operands (a table of nodes; optional): Any number of solids: as further arguments, as a list, or without names in the table, with or without a and b before them.

---The solid of what is in the first operand and in none of the others.
---@param name string name (a string; default 'csg'): Name of the node, for messages.
---@param a gr.node a (a node): A closed solid; a group counts as the union of what is under it.
---@param b gr.node b (a node): The other one.
---@param ... gr.node
---@return gr.node
---@overload fun(a: gr.node, b: gr.node, ...: gr.node): gr.node
---@overload fun(fields: gr.csg_difference.fields): gr.node
function gr.csg_difference(name, a, b, ...) end

---@class gr.csg_intersection.fields
---@field name? string name (a string; default 'csg'): Name of the node, for messages.
---@field a gr.node a (a node): A closed solid; a group counts as the union of what is under it.
---@field b gr.node b (a node): The other one.
---@field operands? gr.node[] operands (a table of nodes; optional): Any number of solids: as further arguments, as a list, or without names in the table, with or without a and b before them.

---The solid of what is in all of the operands.
---@param name string name (a string; default 'csg'): Name of the node, for messages.
---@param a gr.node a (a node): A closed solid; a group counts as the union of what is under it.
---@param b gr.node b (a node): The other one.
---@param ... gr.node
---@return gr.node
---@overload fun(a: gr.node, b: gr.node, ...: gr.node): gr.node
---@overload fun(fields: gr.csg_intersection.fields): gr.node
function gr.csg_intersection(name, a, b, ...) end

---@class gr.csg_merge.fields
---@field name? string name (a string; default 'csg'): Name of the node, for messages.
---@field a gr.node a (a node): A closed solid; a group counts as the union of what is under it.
---@field b gr.node b (a node): The other one.
---@field operands? gr.node[] operands (a table of nodes; optional): Any number of solids: as further arguments, as a list, or without names in the table, with or without a and b before them.

---The same as gr.csg_union, which has no walls inside either; a plain node keeps them.
---@param name string name (a string; default 'csg'): Name of the node, for messages.
---@param a gr.node a (a node): A closed solid; a group counts as the union of what is under it.
---@param b gr.node b (a node): The other one.
---@param ... gr.node
---@return gr.node
---@overload fun(a: gr.node, b: gr.node, ...: gr.node): gr.node
---@overload fun(fields: gr.csg_merge.fields): gr.node
function gr.csg_merge(name, a, b, ...) end

---@class gr.csg_inverse.fields
---@field name? string name (a string; default 'inverse'): Name of the node, for messages.
---@field a gr.node a (a node): A closed solid; a group counts as the union of what is under it.

---The solid of what is not in a: the same surface, turned inside out.
---@param name string name (a string; default 'inverse'): Name of the node, for messages.
---@param a gr.node a (a node): A closed solid; a group counts as the union of what is under it.
---@return gr.node
---@overload fun(a: gr.node): gr.node
---@overload fun(fields: gr.csg_inverse.fields): gr.node
function gr.csg_inverse(name, a) end

---@class gr.union.fields
---@field name? string name (a string; default 'csg'): Name of the node, for messages.
---@field a gr.node a (a node): A closed solid; a group counts as the union of what is under it.
---@field b gr.node b (a node): The other one.
---@field operands? gr.node[] operands (a table of nodes; optional): Any number of solids: as further arguments, as a list, or without names in the table, with or without a and b before them.

---The same as gr.csg_union.
---@param name string name (a string; default 'csg'): Name of the node, for messages.
---@param a gr.node a (a node): A closed solid; a group counts as the union of what is under it.
---@param b gr.node b (a node): The other one.
---@param ... gr.node
---@return gr.node
---@overload fun(a: gr.node, b: gr.node, ...: gr.node): gr.node
---@overload fun(fields: gr.union.fields): gr.node
function gr.union(name, a, b, ...) end

---@class gr.difference.fields
---@field name? string name (a string; default 'csg'): Name of the node, for messages.
---@field a gr.node a (a node): A closed solid; a group counts as the union of what is under it.
---@field b gr.node b (a node): The other one.
---@field operands? gr.node[] operands (a table of nodes; optional): Any number of solids: as further arguments, as a list, or without names in the table, with or without a and b before them.

---The same as gr.csg_difference.
---@param name string name (a string; default 'csg'): Name of the node, for messages.
---@param a gr.node a (a node): A closed solid; a group counts as the union of what is under it.
---@param b gr.node b (a node): The other one.
---@param ... gr.node
---@return gr.node
---@overload fun(a: gr.node, b: gr.node, ...: gr.node): gr.node
---@overload fun(fields: gr.difference.fields): gr.node
function gr.difference(name, a, b, ...) end

---@class gr.intersection.fields
---@field name? string name (a string; default 'csg'): Name of the node, for messages.
---@field a gr.node a (a node): A closed solid; a group counts as the union of what is under it.
---@field b gr.node b (a node): The other one.
---@field operands? gr.node[] operands (a table of nodes; optional): Any number of solids: as further arguments, as a list, or without names in the table, with or without a and b before them.

---The same as gr.csg_intersection.
---@param name string name (a string; default 'csg'): Name of the node, for messages.
---@param a gr.node a (a node): A closed solid; a group counts as the union of what is under it.
---@param b gr.node b (a node): The other one.
---@param ... gr.node
---@return gr.node
---@overload fun(a: gr.node, b: gr.node, ...: gr.node): gr.node
---@overload fun(fields: gr.intersection.fields): gr.node
function gr.intersection(name, a, b, ...) end

---@class gr.merge.fields
---@field name? string name (a string; default 'csg'): Name of the node, for messages.
---@field a gr.node a (a node): A closed solid; a group counts as the union of what is under it.
---@field b gr.node b (a node): The other one.
---@field operands? gr.node[] operands (a table of nodes; optional): Any number of solids: as further arguments, as a list, or without names in the table, with or without a and b before them.

---The same as gr.csg_merge.
---@param name string name (a string; default 'csg'): Name of the node, for messages.
---@param a gr.node a (a node): A closed solid; a group counts as the union of what is under it.
---@param b gr.node b (a node): The other one.
---@param ... gr.node
---@return gr.node
---@overload fun(a: gr.node, b: gr.node, ...: gr.node): gr.node
---@overload fun(fields: gr.merge.fields): gr.node
function gr.merge(name, a, b, ...) end

---@class gr.inverse.fields
---@field name? string name (a string; default 'inverse'): Name of the node, for messages.
---@field a gr.node a (a node): A closed solid; a group counts as the union of what is under it.

---The same as gr.csg_inverse.
---@param name string name (a string; default 'inverse'): Name of the node, for messages.
---@param a gr.node a (a node): A closed solid; a group counts as the union of what is under it.
---@return gr.node
---@overload fun(a: gr.node): gr.node
---@overload fun(fields: gr.inverse.fields): gr.node
function gr.inverse(name, a) end

---@class gr.clipped_by.fields
---@field name? string name (a string; default 'clipped'): Name of the node, for messages.
---@field object gr.node object (a node): What is seen: a shape or a group of them.
---@field by gr.node by (a node): A closed solid: what is inside of it stays.

---The surfaces of an object where they are inside of a solid: cut open, without caps, so that one sees into it; no operand of CSG.
---@param name string name (a string; default 'clipped'): Name of the node, for messages.
---@param object gr.node object (a node): What is seen: a shape or a group of them.
---@param by gr.node by (a node): A closed solid: what is inside of it stays.
---@return gr.node
---@overload fun(object: gr.node, by: gr.node): gr.node
---@overload fun(fields: gr.clipped_by.fields): gr.node
function gr.clipped_by(name, object, by) end

---@class gr.bounded_by.fields
---@field name? string name (a string; default 'bounded'): Name of the node, for messages.
---@field object gr.node object (a node): What is seen: a shape or a group of them.
---@field by gr.node by (a node): A closed solid that nothing of it sticks out of; what does may be seen or not.

---The object, with the hint that it lies in a solid, which makes it faster where its own box is large.
---@param name string name (a string; default 'bounded'): Name of the node, for messages.
---@param object gr.node object (a node): What is seen: a shape or a group of them.
---@param by gr.node by (a node): A closed solid that nothing of it sticks out of; what does may be seen or not.
---@return gr.node
---@overload fun(object: gr.node, by: gr.node): gr.node
---@overload fun(fields: gr.bounded_by.fields): gr.node
function gr.bounded_by(name, object, by) end

---@class gr.cylinder.fields
---@field name? string name (a string; default 'cylinder'): Name of the node, for messages.
---@field material? gr.material material (a material; default plain gray): What its surface looks like.
---@field from? gr.triple from (a point {x, y, z}; default {0, -1, 0}): The middle of one end.
---@field to? gr.triple to (a point {x, y, z}; default {0, 1, 0}): The middle of the other end.
---@field radius? number radius (a number, > 0; default 1): Radius.
---@field open? boolean open (true or false; default false): Whether it is a mere surface without caps; then it is no solid for CSG.

---A capped cylinder; about y, of radius 1, from y = -1 to 1 if nothing else is said.
---@param material gr.material material (a material; default plain gray): What its surface looks like.
---@return gr.node
---@overload fun(name: string): gr.node
---@overload fun(fields: gr.cylinder.fields): gr.node
function gr.cylinder(material) end

---@class gr.cone.fields
---@field name? string name (a string; default 'cone'): Name of the node, for messages.
---@field material? gr.material material (a material; default plain gray): What its surface looks like.
---@field from? gr.triple from (a point {x, y, z}; default {0, 0, 0}): The apex, or the middle of the end with from_radius.
---@field to? gr.triple to (a point {x, y, z}; default {0, 1, 0}): The middle of the end with radius.
---@field from_radius? number from_radius (a number, >= 0; default 0): Radius at from: a frustum.
---@field radius? number radius (a number, >= 0; default 1): Radius at to.
---@field open? boolean open (true or false; default false): Whether it is a mere surface without caps; then it is no solid for CSG.

---A capped cone or frustum; apex at the origin, radius 1 at y = 1 if nothing else is said.
---@param material gr.material material (a material; default plain gray): What its surface looks like.
---@return gr.node
---@overload fun(name: string): gr.node
---@overload fun(fields: gr.cone.fields): gr.node
function gr.cone(material) end

---@class gr.torus.fields
---@field name? string name (a string; default 'torus'): Name of the node, for messages.
---@field material? gr.material material (a material; default plain gray): What its surface looks like.
---@field major? number major (a number, >= 0; default 1): Radius of the circle in y = 0.
---@field minor? number minor (a number, > 0; default 0.25): Radius of the tube around it.

---A torus about the y axis.
---@param name string name (a string; default 'torus'): Name of the node, for messages.
---@param major? number major (a number, >= 0; default 1): Radius of the circle in y = 0.
---@param minor? number minor (a number, > 0; default 0.25): Radius of the tube around it.
---@return gr.node
---@overload fun(material: gr.material, major?: number, minor?: number): gr.node
---@overload fun(fields: gr.torus.fields): gr.node
function gr.torus(name, major, minor) end

---@class gr.plane.fields
---@field name? string name (a string; default 'plane'): Name of the node, for messages.
---@field material? gr.material material (a material; default plain gray): What its surface looks like.
---@field normal? gr.triple normal (a direction {x, y, z}; default none: the square): A plane without end that faces there; a half-space in CSG.
---@field distance? number distance (a number; default 0): How far from the origin it is, along the normal.

---The square from -0.5 to 0.5 in x and z at y = 0; with a normal a plane without end.
---@param material gr.material material (a material; default plain gray): What its surface looks like.
---@return gr.node
---@overload fun(name: string): gr.node
---@overload fun(fields: gr.plane.fields): gr.node
function gr.plane(material) end

---@class gr.square.fields
---@field name? string name (a string; default 'square'): Name of the node, for messages.
---@field material? gr.material material (a material; default plain gray): What its surface looks like.

---The square from -0.5 to 0.5 in x and z at y = 0.
---@param material gr.material material (a material; default plain gray): What its surface looks like.
---@return gr.node
---@overload fun(name: string): gr.node
---@overload fun(fields: gr.square.fields): gr.node
function gr.square(material) end

---@class gr.box.fields
---@field name? string name (a string; default 'box'): Name of the node, for messages.
---@field material? gr.material material (a material; default plain gray): What its surface looks like.
---@field min gr.triple min (a point {x, y, z}): A corner.
---@field max gr.triple max (a point {x, y, z}): The opposite corner.

---A box between two corners.
---@param material gr.material material (a material; default plain gray): What its surface looks like.
---@param min gr.triple min (a point {x, y, z}): A corner.
---@param max gr.triple max (a point {x, y, z}): The opposite corner.
---@return gr.node
---@overload fun(name: string, min: gr.triple, max: gr.triple): gr.node
---@overload fun(fields: gr.box.fields): gr.node
function gr.box(material, min, max) end

---@class gr.ellipsoid.fields
---@field name? string name (a string; default 'ellipsoid'): Name of the node, for messages.
---@field material? gr.material material (a material; default plain gray): What its surface looks like.
---@field centre? gr.triple centre (a point {x, y, z}; default {0, 0, 0}): Centre.
---@field radii? number|gr.triple radii (a number or a table of 3 numbers; default 1): Radii along x, y and z, one number or three.

---An ellipsoid along the axes.
---@param material gr.material material (a material; default plain gray): What its surface looks like.
---@param radii? number|gr.triple radii (a number or a table of 3 numbers; default 1): Radii along x, y and z, one number or three.
---@return gr.node
---@overload fun(name: string, radii?: number|gr.triple): gr.node
---@overload fun(fields: gr.ellipsoid.fields): gr.node
function gr.ellipsoid(material, radii) end

---@class gr.paraboloid.fields
---@field name? string name (a string; default 'paraboloid'): Name of the node, for messages.
---@field material? gr.material material (a material; default plain gray): What its surface looks like.
---@field radius? number radius (a number, > 0; default 1): Radius of the rim.
---@field height? number height (a number, > 0; default 1): The tip is at the origin, the rim at this y.
---@field open? boolean open (true or false; default false): Whether it is a mere surface without caps; then it is no solid for CSG.

---A capped paraboloid that opens along y.
---@param material gr.material material (a material; default plain gray): What its surface looks like.
---@return gr.node
---@overload fun(name: string): gr.node
---@overload fun(fields: gr.paraboloid.fields): gr.node
function gr.paraboloid(material) end

---@class gr.hyperboloid.fields
---@field name? string name (a string; default 'hyperboloid'): Name of the node, for messages.
---@field material? gr.material material (a material; default plain gray): What its surface looks like.
---@field sheets? integer sheets (a whole number, 1 to 2; default 1, with gap 2): One sheet with a waist, or two bowls.
---@field radius? number radius (a number, > 0; default twice waist, or 1): Radius of both rims.
---@field height? number height (a number, > 0; default twice gap, or 1): The rims are at this y and at minus this y.
---@field waist? number waist (a number, > 0; default radius/2): One sheet: radius at y = 0.
---@field gap? number gap (a number, > 0; default height/2): Two sheets: the tips are at this y and at minus this y.
---@field open? boolean open (true or false; default false): Whether it is a mere surface without caps; then it is no solid for CSG.

---A capped hyperboloid about y, of one sheet or of two.
---@param material gr.material material (a material; default plain gray): What its surface looks like.
---@return gr.node
---@overload fun(name: string): gr.node
---@overload fun(fields: gr.hyperboloid.fields): gr.node
function gr.hyperboloid(material) end

---@class gr.quadric.fields
---@field name? string name (a string; default 'quadric'): Name of the node, for messages.
---@field material? gr.material material (a material; default plain gray): What its surface looks like.
---@field xx? number xx (a number; default 0): Coefficient.
---@field yy? number yy (a number; default 0): Coefficient.
---@field zz? number zz (a number; default 0): Coefficient.
---@field xy? number xy (a number; default 0): Coefficient.
---@field xz? number xz (a number; default 0): Coefficient.
---@field yz? number yz (a number; default 0): Coefficient.
---@field x? number x (a number; default 0): Coefficient.
---@field y? number y (a number; default 0): Coefficient.
---@field z? number z (a number; default 0): Coefficient.
---@field constant? number constant (a number; default 0): The solid is where the sum of all is negative.
---@field min? gr.triple min (a point {x, y, z}; default without end): Corner of the box that limits it.
---@field max? gr.triple max (a point {x, y, z}; default without end): The opposite corner.
---@field open? boolean open (true or false; default false): Whether it is a mere surface without caps; then it is no solid for CSG.

---Where xx x^2 + yy y^2 + zz z^2 + xy x y + xz x z + yz y z + x x + y y + z z + constant is negative.
---@param material gr.material material (a material; default plain gray): What its surface looks like.
---@param xx number xx (a number; default 0): Coefficient.
---@param yy number yy (a number; default 0): Coefficient.
---@param zz number zz (a number; default 0): Coefficient.
---@param constant number constant (a number; default 0): The solid is where the sum of all is negative.
---@return gr.node
---@overload fun(name: string, xx: number, yy: number, zz: number, constant: number): gr.node
---@overload fun(fields: gr.quadric.fields): gr.node
function gr.quadric(material, xx, yy, zz, constant) end

---@class gr.superellipsoid.fields
---@field name? string name (a string; default 'superellipsoid'): Name of the node, for messages.
---@field material? gr.material material (a material; default plain gray): What its surface looks like.
---@field e? number e (a number, 0.02 to 20; default 1): Roundness seen along y: near 0 a square, 1 a circle, 2 a diamond.
---@field n? number n (a number, 0.02 to 20; default 1): Roundness of the profile, likewise.

---A rounded cube, cylinder, double cone or star: (|x|^(2/e) + |z|^(2/e))^(e/n) + |y|^(2/n) = 1.
---@param material gr.material material (a material; default plain gray): What its surface looks like.
---@param e? number e (a number, 0.02 to 20; default 1): Roundness seen along y: near 0 a square, 1 a circle, 2 a diamond.
---@param n? number n (a number, 0.02 to 20; default 1): Roundness of the profile, likewise.
---@return gr.node
---@overload fun(name: string, e?: number, n?: number): gr.node
---@overload fun(fields: gr.superellipsoid.fields): gr.node
function gr.superellipsoid(material, e, n) end

---@class gr.rectangle.fields
---@field name? string name (a string; default 'rectangle'): Name of the node, for messages.
---@field material? gr.material material (a material; default plain gray): What its surface looks like.
---@field corner? gr.triple corner (a point {x, y, z}; default {-0.5, 0, 0.5}): The lower left corner of an image on it.
---@field along? gr.triple along (a direction {x, y, z}; default {1, 0, 0}): The edge to the right.
---@field up? gr.triple up (a direction {x, y, z}; default {0, 0, -1}): The edge upwards; not parallel, or else any.

---A rectangle or parallelogram.
---@param material gr.material material (a material; default plain gray): What its surface looks like.
---@param corner? gr.triple corner (a point {x, y, z}; default {-0.5, 0, 0.5}): The lower left corner of an image on it.
---@param along? gr.triple along (a direction {x, y, z}; default {1, 0, 0}): The edge to the right.
---@param up? gr.triple up (a direction {x, y, z}; default {0, 0, -1}): The edge upwards; not parallel, or else any.
---@return gr.node
---@overload fun(name: string, corner?: gr.triple, along?: gr.triple, up?: gr.triple): gr.node
---@overload fun(fields: gr.rectangle.fields): gr.node
function gr.rectangle(material, corner, along, up) end

---@class gr.disc.fields
---@field name? string name (a string; default 'disc'): Name of the node, for messages.
---@field material? gr.material material (a material; default plain gray): What its surface looks like.
---@field centre? gr.triple centre (a point {x, y, z}; default {0, 0, 0}): Centre.
---@field normal? gr.triple normal (a direction {x, y, z}; default {0, 1, 0}): Where its front looks.
---@field radius? number radius (a number, > 0; default 1, or twice inner): Radius.
---@field inner? number inner (a number, >= 0; default 0): Radius of the hole.

---A disc, or a ring.
---@param material gr.material material (a material; default plain gray): What its surface looks like.
---@return gr.node
---@overload fun(name: string): gr.node
---@overload fun(fields: gr.disc.fields): gr.node
function gr.disc(material) end

---@class gr.triangle.fields
---@field name? string name (a string; default 'triangle'): Name of the node, for messages.
---@field material? gr.material material (a material; default plain gray): What its surface looks like.
---@field a gr.triple a (a point {x, y, z}): A corner; the front sees a, b, c counter-clockwise.
---@field b gr.triple b (a point {x, y, z}): The next corner.
---@field c gr.triple c (a point {x, y, z}): The last corner.

---A triangle.
---@param material gr.material material (a material; default plain gray): What its surface looks like.
---@param a gr.triple a (a point {x, y, z}): A corner; the front sees a, b, c counter-clockwise.
---@param b gr.triple b (a point {x, y, z}): The next corner.
---@param c gr.triple c (a point {x, y, z}): The last corner.
---@return gr.node
---@overload fun(name: string, a: gr.triple, b: gr.triple, c: gr.triple): gr.node
---@overload fun(fields: gr.triangle.fields): gr.node
function gr.triangle(material, a, b, c) end

---@class gr.polygon.fields
---@field name? string name (a string; default 'polygon'): Name of the node, for messages.
---@field material? gr.material material (a material; default plain gray): What its surface looks like.
---@field points gr.triple[] points (a table of points {x, y, z}): Corners in one plane; the front sees the first outline counter-clockwise.
---@field outlines? integer[][] outlines (a table of tuples of indices; default all points in turn): Tuples of 0-based indices into points; what an odd number of them surrounds is filled.

---A polygon of any outline, with holes.
---@param material gr.material material (a material; default plain gray): What its surface looks like.
---@param points gr.triple[] points (a table of points {x, y, z}): Corners in one plane; the front sees the first outline counter-clockwise.
---@param outlines? integer[][] outlines (a table of tuples of indices; default all points in turn): Tuples of 0-based indices into points; what an odd number of them surrounds is filled.
---@return gr.node
---@overload fun(name: string, points: gr.triple[], outlines?: integer[][]): gr.node
---@overload fun(fields: gr.polygon.fields): gr.node
function gr.polygon(material, points, outlines) end

---@class gr.lathe.fields
---@field name? string name (a string; default 'lathe'): Name of the node, for messages.
---@field material? gr.material material (a material; default plain gray): What its surface looks like.
---@field points number[][] points (a table of pairs {u, v}): The profile: pairs of radius and y.
---@field spline? 'linear'|'catmull-rom'|'b-spline'|'bezier' spline ('linear'|'catmull-rom'|'b-spline'|'bezier'; default 'linear'): How the points are joined; bezier takes 3 n + 1 of them.
---@field loop? boolean loop (true or false; default false): Whether the profile goes back to its first point.
---@field open? boolean open (true or false; default false): Whether ends off the axis stay open, not closed by discs.

---A profile turned about the y axis.
---@param material gr.material material (a material; default plain gray): What its surface looks like.
---@param points number[][] points (a table of pairs {u, v}): The profile: pairs of radius and y.
---@param spline? 'linear'|'catmull-rom'|'b-spline'|'bezier' spline ('linear'|'catmull-rom'|'b-spline'|'bezier'; default 'linear'): How the points are joined; bezier takes 3 n + 1 of them.
---@return gr.node
---@overload fun(name: string, points: number[][], spline?: 'linear'|'catmull-rom'|'b-spline'|'bezier'): gr.node
---@overload fun(fields: gr.lathe.fields): gr.node
function gr.lathe(material, points, spline) end

---@class gr.prism.fields
---@field name? string name (a string; default 'prism'): Name of the node, for messages.
---@field material? gr.material material (a material; default plain gray): What its surface looks like.
---@field outline number[][] outline (a table of pairs {u, v}): A closed curve: pairs of x and z.
---@field holes? number[][][] holes (a table of tables of pairs {x, z}; default none): More closed curves; what an odd number of all surrounds is solid.
---@field from? number from (a number; default 0): Height of the bottom.
---@field to? number to (a number; default from + 1): Height of the top.
---@field spline? 'linear'|'catmull-rom'|'b-spline'|'bezier' spline ('linear'|'catmull-rom'|'b-spline'|'bezier'; default 'linear'): How the points are joined; bezier takes 3 n of them.

---An outline drawn out along y, with holes.
---@param material gr.material material (a material; default plain gray): What its surface looks like.
---@param outline number[][] outline (a table of pairs {u, v}): A closed curve: pairs of x and z.
---@return gr.node
---@overload fun(name: string, outline: number[][]): gr.node
---@overload fun(fields: gr.prism.fields): gr.node
function gr.prism(material, outline) end

---@class gr.sweep.fields
---@field name? string name (a string; default 'sweep'): Name of the node, for messages.
---@field material? gr.material material (a material; default plain gray): What its surface looks like.
---@field points gr.triple[] points (a table of points {x, y, z}): Where the centre of the ball goes.
---@field radii number|number[] radii (a number or a table of numbers, >= 0): Its radius at each point, or one for all.
---@field spline? 'linear'|'catmull-rom'|'b-spline'|'bezier' spline ('linear'|'catmull-rom'|'b-spline'|'bezier'; default 'catmull-rom'): How the points are joined; bezier takes 3 n + 1 of them.
---@field loop? boolean loop (true or false; default false): Whether it goes back to the first point.

---What a ball covers that moves along a spline.
---@param material gr.material material (a material; default plain gray): What its surface looks like.
---@param points gr.triple[] points (a table of points {x, y, z}): Where the centre of the ball goes.
---@param radii number|number[] radii (a number or a table of numbers, >= 0): Its radius at each point, or one for all.
---@param spline? 'linear'|'catmull-rom'|'b-spline'|'bezier' spline ('linear'|'catmull-rom'|'b-spline'|'bezier'; default 'catmull-rom'): How the points are joined; bezier takes 3 n + 1 of them.
---@return gr.node
---@overload fun(name: string, points: gr.triple[], radii: number|number[], spline?: 'linear'|'catmull-rom'|'b-spline'|'bezier'): gr.node
---@overload fun(fields: gr.sweep.fields): gr.node
function gr.sweep(material, points, radii, spline) end

---@class gr.height_field.fields
---@field name? string name (a string; default 'height field'): Name of the node, for messages.
---@field material? gr.material material (a material; default plain gray): What its surface looks like.
---@field heights? number[][] heights (a table of tables of numbers; optional): Rows of equally many heights; x runs within a row, z from row to row.
---@field image? string|gr.texture image (the name of a picture file or a texture; optional): A picture instead: black is 0, white is 1, its upper edge is z = 0.
---@field floor? number floor (a number; default a tenth of the relief below it): Height of the solid's floor.
---@field open? boolean open (true or false; default false): Whether it is a sheet without walls and floor.
---@field smooth? boolean smooth (true or false; default false): Whether it is shaded with interpolated normals.

---Land over the square from 0 to 1 in x and z, a solid down to its floor.
---@param material gr.material material (a material; default plain gray): What its surface looks like.
---@param heights number[][] heights (a table of tables of numbers; optional): Rows of equally many heights; x runs within a row, z from row to row.
---@return gr.node
---@overload fun(name: string, heights: number[][]): gr.node
---@overload fun(fields: gr.height_field.fields): gr.node
function gr.height_field(material, heights) end

---@class gr.blob.fields
---@field name? string name (a string; default 'blob'): Name of the node, for messages.
---@field material? gr.material material (a material; default plain gray): What its surface looks like.
---@field spheres? number[][] spheres (a table of tables of numbers; default {}): Balls {x, y, z, radius, strength}; strength 1 may be left out.
---@field cylinders? number[][] cylinders (a table of tables of numbers; default {}): Rods {x1, y1, z1, x2, y2, z2, radius, strength}.
---@field threshold? number threshold (a number, > 0; default 0.5): The surface is where the fields, strength (1 - (distance/radius)^2)^2, add up to this.

---Balls and rods that flow into each other.
---@param material gr.material material (a material; default plain gray): What its surface looks like.
---@param spheres number[][] spheres (a table of tables of numbers; default {}): Balls {x, y, z, radius, strength}; strength 1 may be left out.
---@param cylinders? number[][] cylinders (a table of tables of numbers; default {}): Rods {x1, y1, z1, x2, y2, z2, radius, strength}.
---@param threshold? number threshold (a number, > 0; default 0.5): The surface is where the fields, strength (1 - (distance/radius)^2)^2, add up to this.
---@return gr.node
---@overload fun(name: string, spheres: number[][], cylinders?: number[][], threshold?: number): gr.node
---@overload fun(fields: gr.blob.fields): gr.node
function gr.blob(material, spheres, cylinders, threshold) end

---@class gr.curve.fields
---@field name? string name (a string; default 'curve'): Name of the node, for messages.
---@field material? gr.material material (a material; default plain gray): What its surface looks like.
---@field points gr.triple[] points (a table of points {x, y, z}): Where it goes.
---@field widths number|number[] widths (a number or a table of numbers, >= 0): Its width at each point, or one for all.
---@field spline? 'linear'|'catmull-rom'|'b-spline'|'bezier' spline ('linear'|'catmull-rom'|'b-spline'|'bezier'; default 'catmull-rom'): How the points are joined; bezier takes 3 n + 1 of them.
---@field flat? boolean flat (true or false; default false): Whether it is shaded as a ribbon, not as a round hair.

---A hair: a ribbon along a spline that faces every ray.
---@param material gr.material material (a material; default plain gray): What its surface looks like.
---@param points gr.triple[] points (a table of points {x, y, z}): Where it goes.
---@param widths number|number[] widths (a number or a table of numbers, >= 0): Its width at each point, or one for all.
---@param spline? 'linear'|'catmull-rom'|'b-spline'|'bezier' spline ('linear'|'catmull-rom'|'b-spline'|'bezier'; default 'catmull-rom'): How the points are joined; bezier takes 3 n + 1 of them.
---@return gr.node
---@overload fun(name: string, points: gr.triple[], widths: number|number[], spline?: 'linear'|'catmull-rom'|'b-spline'|'bezier'): gr.node
---@overload fun(fields: gr.curve.fields): gr.node
function gr.curve(material, points, widths, spline) end

---@class gr.patch.fields
---@field name? string name (a string; default 'patch'): Name of the node, for messages.
---@field material? gr.material material (a material; default plain gray): What its surface looks like.
---@field points gr.triple[] points (a table of points {x, y, z}): Control points, 16 for each patch in 4 rows of 4.
---@field patches? integer[][] patches (a table of tuples of indices; default points in turn): Tuples of 16 0-based indices into points.
---@field tolerance? number tolerance (a number, > 0; default a thousandth of the size): The largest distance of the triangles from the true surface.
---@field flip? boolean flip (true or false; default false): Whether the front is the other side.

---Bicubic Bezier patches, as a mesh.
---@param material gr.material material (a material; default plain gray): What its surface looks like.
---@param points gr.triple[] points (a table of points {x, y, z}): Control points, 16 for each patch in 4 rows of 4.
---@param patches? integer[][] patches (a table of tuples of indices; default points in turn): Tuples of 16 0-based indices into points.
---@return gr.node
---@overload fun(name: string, points: gr.triple[], patches?: integer[][]): gr.node
---@overload fun(fields: gr.patch.fields): gr.node
function gr.patch(material, points, patches) end

---@class gr.marble_texture.fields
---@field f number f (a number): Factor of the place before the noise.
---@field multiplier number multiplier (a number): How much the noise bends the veins.
---@field vein_frequency number vein_frequency (a number): How close the veins are along y.
---@field interp? integer interp (a whole number, 0 to 1; default 0): How the noise is interpolated: 0 linear, 1 cosine.

---Veins between 0 and 1, for inputs of gr.material.
---@param f number f (a number): Factor of the place before the noise.
---@param multiplier number multiplier (a number): How much the noise bends the veins.
---@param vein_frequency number vein_frequency (a number): How close the veins are along y.
---@param interp? integer interp (a whole number, 0 to 1; default 0): How the noise is interpolated: 0 linear, 1 cosine.
---@return gr.texture
---@overload fun(fields: gr.marble_texture.fields): gr.texture
function gr.marble_texture(f, multiplier, vein_frequency, interp) end

---@class gr.wood_texture.fields
---@field f number f (a number): Factor of the place before the noise.
---@field density number density (a number): How close the grain is.
---@field interp? integer interp (a whole number, 0 to 1; default 0): How the noise is interpolated: 0 linear, 1 cosine.

---Grain between 0 and 1, for inputs of gr.material.
---@param f number f (a number): Factor of the place before the noise.
---@param density number density (a number): How close the grain is.
---@param interp? integer interp (a whole number, 0 to 1; default 0): How the noise is interpolated: 0 linear, 1 cosine.
---@return gr.texture
---@overload fun(fields: gr.wood_texture.fields): gr.texture
function gr.wood_texture(f, density, interp) end

---@class gr.mix_texture.fields
---@field a number|gr.triple|gr.texture a (a number or a table of 3 numbers or a texture): What is there where ratio is 1: a number, a colour or a texture.
---@field b number|gr.triple|gr.texture b (a number or a table of 3 numbers or a texture): What is there where ratio is 0.
---@field ratio? number|gr.texture ratio (a number or a texture; default 0.5): a * ratio + b * (1 - ratio).

---Two textures or colours mixed by a third.
---@param a number|gr.triple|gr.texture a (a number or a table of 3 numbers or a texture): What is there where ratio is 1: a number, a colour or a texture.
---@param b number|gr.triple|gr.texture b (a number or a table of 3 numbers or a texture): What is there where ratio is 0.
---@param ratio? number|gr.texture ratio (a number or a texture; default 0.5): a * ratio + b * (1 - ratio).
---@return gr.texture
---@overload fun(fields: gr.mix_texture.fields): gr.texture
function gr.mix_texture(a, b, ratio) end

---@class gr.multiply_texture.fields
---@field a number|gr.triple|gr.texture a (a number or a table of 3 numbers or a texture): One factor: a number, a colour or a texture.
---@field b number|gr.triple|gr.texture b (a number or a table of 3 numbers or a texture): The other.

---The product of two textures or colours.
---@param a number|gr.triple|gr.texture a (a number or a table of 3 numbers or a texture): One factor: a number, a colour or a texture.
---@param b number|gr.triple|gr.texture b (a number or a table of 3 numbers or a texture): The other.
---@return gr.texture
---@overload fun(fields: gr.multiply_texture.fields): gr.texture
function gr.multiply_texture(a, b) end

---@class gr.material.fields
---@field kd gr.triple|gr.texture kd (a colour {r, g, b} or a texture): Colour of diffuse and ambient light.
---@field ks? gr.triple|gr.texture ks (a colour {r, g, b} or a texture; default {0, 0, 0}): Colour of highlights, filter of secondary rays.
---@field shininess? number|gr.texture shininess (a number or a texture, >= 0; default 1): Exponent of the highlight.
---@field reflect? number|gr.texture reflect (a number or a texture, 0 to 1; default 0): Amount of reflected light.
---@field refract? number|gr.texture refract (a number or a texture, 0 to 1; default 0): Amount of refracted light.
---@field ior? number ior (a number, >= 1; default none): Index of refraction of the inside.
---@field two_sided? boolean two_sided (true or false; default false): Whether faces seen from behind are lit as well.
---@field highlight? 'phong'|'blinn' highlight ('phong'|'blinn'; default specular of the render): The form of its highlight.
---@field lit? boolean lit (true or false; default true): Whether light is looked for; false: kd is shown as it is.
---@field emission? gr.triple|gr.texture emission (a colour {r, g, b} or a texture; default {0, 0, 0}): Light of its own, added to what it reflects.
---@field roughness? number|gr.texture roughness (a number or a texture, 0 to 1; default 0): Of reflection and refraction: 0 is polished.
---@field glossy_samples? integer glossy_samples (a whole number, 1 to 64; default 4): N x N rays where it is rough; one ray after another rough surface.
---@field absorption? gr.triple absorption (a colour {r, g, b}, >= 0; default {0, 0, 0}): Inside, light fades by exp(-absorption * distance).
---@field opacity? number|gr.texture opacity (a number or a texture, 0 to 1; default 1): How much of the surface is there; the rest is a hole.
---@field metalness? number|gr.texture metalness (a number or a texture, 0 to 1; default 0): The share of kd that colours highlights and mirrored light instead.
---@field bump? string|gr.texture bump (the name of a picture file or a texture; default none): Heights: what gr.bump made, a file or a texture.

---A Phong material.
---@param kd gr.triple|gr.texture kd (a colour {r, g, b} or a texture): Colour of diffuse and ambient light.
---@param ks gr.triple|gr.texture ks (a colour {r, g, b} or a texture; default {0, 0, 0}): Colour of highlights, filter of secondary rays.
---@param shininess number|gr.texture shininess (a number or a texture, >= 0; default 1): Exponent of the highlight.
---@return gr.material
---@overload fun(fields: gr.material.fields): gr.material
function gr.material(kd, ks, shininess) end

---@class gr.rr_material.fields
---@field kd gr.triple|gr.texture kd (a colour {r, g, b} or a texture): Colour of diffuse and ambient light.
---@field ks? gr.triple|gr.texture ks (a colour {r, g, b} or a texture; default {0, 0, 0}): Colour of highlights, filter of secondary rays.
---@field shininess? number|gr.texture shininess (a number or a texture, >= 0; default 1): Exponent of the highlight.
---@field reflect? number|gr.texture reflect (a number or a texture, 0 to 1; default 0): Amount of reflected light.
---@field refract? number|gr.texture refract (a number or a texture, 0 to 1; default 0): Amount of refracted light.
---@field ior? number ior (a number, >= 1; default 1): Index of refraction of the inside.
---@field two_sided? boolean two_sided (true or false; default false): Whether faces seen from behind are lit as well.
---@field highlight? 'phong'|'blinn' highlight ('phong'|'blinn'; default specular of the render): The form of its highlight.
---@field lit? boolean lit (true or false; default true): Whether light is looked for; false: kd is shown as it is.
---@field emission? gr.triple|gr.texture emission (a colour {r, g, b} or a texture; default {0, 0, 0}): Light of its own, added to what it reflects.
---@field roughness? number|gr.texture roughness (a number or a texture, 0 to 1; default 0): Of reflection and refraction: 0 is polished.
---@field glossy_samples? integer glossy_samples (a whole number, 1 to 64; default 4): N x N rays where it is rough; one ray after another rough surface.
---@field absorption? gr.triple absorption (a colour {r, g, b}, >= 0; default {0, 0, 0}): Inside, light fades by exp(-absorption * distance).
---@field opacity? number|gr.texture opacity (a number or a texture, 0 to 1; default 1): How much of the surface is there; the rest is a hole.
---@field metalness? number|gr.texture metalness (a number or a texture, 0 to 1; default 0): The share of kd that colours highlights and mirrored light instead.
---@field bump? string|gr.texture bump (the name of a picture file or a texture; default none): Heights: what gr.bump made, a file or a texture.

---A Phong material that reflects and refracts.
---@param kd gr.triple|gr.texture kd (a colour {r, g, b} or a texture): Colour of diffuse and ambient light.
---@param ks gr.triple|gr.texture ks (a colour {r, g, b} or a texture; default {0, 0, 0}): Colour of highlights, filter of secondary rays.
---@param shininess number|gr.texture shininess (a number or a texture, >= 0; default 1): Exponent of the highlight.
---@param reflect number|gr.texture reflect (a number or a texture, 0 to 1; default 0): Amount of reflected light.
---@param refract number|gr.texture refract (a number or a texture, 0 to 1; default 0): Amount of refracted light.
---@param ior number ior (a number, >= 1; default 1): Index of refraction of the inside.
---@return gr.material
---@overload fun(fields: gr.rr_material.fields): gr.material
function gr.rr_material(kd, ks, shininess, reflect, refract, ior) end

---@class gr.marble_pnd_material.fields
---@field material gr.material material (a material): The material below.
---@field f number f (a number): Factor of the place before the noise.
---@field multiplier number multiplier (a number): How much the noise bends the veins.
---@field vein_frequency number vein_frequency (a number): How close the veins are along y.
---@field interp? integer interp (a whole number, 0 to 1; default 0): How the noise is interpolated: 0 linear, 1 cosine.
---@field mix gr.triple mix (a colour {r, g, b}): The colour mixed with kd.

---Marble over another material.
---@param material gr.material material (a material): The material below.
---@param f number f (a number): Factor of the place before the noise.
---@param multiplier number multiplier (a number): How much the noise bends the veins.
---@param vein_frequency number vein_frequency (a number): How close the veins are along y.
---@param interp integer interp (a whole number, 0 to 1; default 0): How the noise is interpolated: 0 linear, 1 cosine.
---@param mix gr.triple mix (a colour {r, g, b}): The colour mixed with kd.
---@return gr.material
---@overload fun(fields: gr.marble_pnd_material.fields): gr.material
function gr.marble_pnd_material(material, f, multiplier, vein_frequency, interp, mix) end

---@class gr.wood_pnd_material.fields
---@field material gr.material material (a material): The material below.
---@field f number f (a number): Factor of the place before the noise.
---@field density number density (a number): How close the grain is.
---@field interp? integer interp (a whole number, 0 to 1; default 0): How the noise is interpolated: 0 linear, 1 cosine.
---@field mix gr.triple mix (a colour {r, g, b}): The colour mixed with kd.

---Wood over another material.
---@param material gr.material material (a material): The material below.
---@param f number f (a number): Factor of the place before the noise.
---@param density number density (a number): How close the grain is.
---@param interp integer interp (a whole number, 0 to 1; default 0): How the noise is interpolated: 0 linear, 1 cosine.
---@param mix gr.triple mix (a colour {r, g, b}): The colour mixed with kd.
---@return gr.material
---@overload fun(fields: gr.wood_pnd_material.fields): gr.material
function gr.wood_pnd_material(material, f, density, interp, mix) end

---@class gr.td_cube_material.fields
---@field material gr.material material (a material): The material below.
---@field png string|gr.texture png (the name of a picture file or a texture): A PNG or JPEG file, or a texture.
---@field filter? 'nearest'|'bilinear'|'mipmap' filter ('nearest'|'bilinear'|'mipmap'; default 'mipmap'): How the image is looked up.
---@field flip_u? boolean flip_u (true or false; default false): Whether left and right are exchanged.

---An image on each side of the unit cube, over another material.
---@param material gr.material material (a material): The material below.
---@param png string|gr.texture png (the name of a picture file or a texture): A PNG or JPEG file, or a texture.
---@return gr.material
---@overload fun(fields: gr.td_cube_material.fields): gr.material
function gr.td_cube_material(material, png) end

---@class gr.td_sphere_material.fields
---@field material gr.material material (a material): The material below.
---@field png string|gr.texture png (the name of a picture file or a texture): A PNG or JPEG file, or a texture.
---@field filter? 'nearest'|'bilinear'|'mipmap' filter ('nearest'|'bilinear'|'mipmap'; default 'mipmap'): How the image is looked up.
---@field flip_u? boolean flip_u (true or false; default false): Whether left and right are exchanged.

---An image around the unit sphere, over another material.
---@param material gr.material material (a material): The material below.
---@param png string|gr.texture png (the name of a picture file or a texture): A PNG or JPEG file, or a texture.
---@return gr.material
---@overload fun(fields: gr.td_sphere_material.fields): gr.material
function gr.td_sphere_material(material, png) end

---@class gr.difresnel_material.fields
---@field material gr.material material (a material): The material below.

---A dielectric: reflects and refracts by Fresnel's equations.
---@param material gr.material material (a material): The material below.
---@return gr.material
---@overload fun(fields: gr.difresnel_material.fields): gr.material
function gr.difresnel_material(material) end

---@class gr.difresneld_material.fields
---@field material gr.material material (a material): The material below.

---The same as gr.difresnel_material.
---@param material gr.material material (a material): The material below.
---@return gr.material
---@overload fun(fields: gr.difresneld_material.fields): gr.material
function gr.difresneld_material(material) end

---@class gr.texture.fields
---@field file string|gr.texture file (the name of a picture file or a texture): A PNG or JPEG file.
---@field filter? 'nearest'|'bilinear'|'mipmap' filter ('nearest'|'bilinear'|'mipmap'; default 'mipmap'): How the image is looked up.
---@field wrap? 'clamp'|'repeat'|'mirror' wrap ('clamp'|'repeat'|'mirror'; default 'repeat'): What is beyond its edges.
---@field flip_u? boolean flip_u (true or false; default false): Whether left and right are exchanged.
---@field tiles? number|number[] tiles (a number or a table of 2 numbers; default 1): How many lie side by side: one number, or {across, up}.
---@field offset? number|number[] offset (a number or a table of 2 numbers; default 0): How far it is moved, in pictures: {across, up}.

---An image for node:set_texture, or for inputs of gr.material.
---@param file string|gr.texture file (the name of a picture file or a texture): A PNG or JPEG file.
---@return gr.texture
---@overload fun(fields: gr.texture.fields): gr.texture
function gr.texture(file) end

---@class gr.bump.fields
---@field file string|gr.texture file (the name of a picture file or a texture): A PNG or JPEG file, or any texture.
---@field filter? 'nearest'|'bilinear'|'mipmap' filter ('nearest'|'bilinear'|'mipmap'; default 'mipmap'): How the image is looked up.
---@field wrap? 'clamp'|'repeat'|'mirror' wrap ('clamp'|'repeat'|'mirror'; default 'repeat'): What is beyond its edges.
---@field flip_u? boolean flip_u (true or false; default false): Whether left and right are exchanged.
---@field tiles? number|number[] tiles (a number or a table of 2 numbers; default 1): How many lie side by side: one number, or {across, up}.
---@field offset? number|number[] offset (a number or a table of 2 numbers; default 0): How far it is moved, in pictures: {across, up}.
---@field height? number height (a number; default 1/50 of the picture's size; 1 for normals): White over black in units of the object; of normals, a factor of their slopes.
---@field kind? 'bump'|'normal' kind ('bump'|'normal'; default 'bump'): Whether it holds heights, or normals as colours: x right, y up, z out.

---A bump map or normal map for node:set_bump.
---@param file string|gr.texture file (the name of a picture file or a texture): A PNG or JPEG file, or any texture.
---@param height? number height (a number; default 1/50 of the picture's size; 1 for normals): White over black in units of the object; of normals, a factor of their slopes.
---@return gr.texture
---@overload fun(fields: gr.bump.fields): gr.texture
function gr.bump(file, height) end

---@class gr.image_material.fields
---@field material gr.material material (a material): The material below.
---@field image string|gr.texture image (the name of a picture file or a texture): A PNG or JPEG file, or a texture.
---@field filter? 'nearest'|'bilinear'|'mipmap' filter ('nearest'|'bilinear'|'mipmap'; default 'mipmap'): How the image is looked up.
---@field wrap? 'clamp'|'repeat'|'mirror' wrap ('clamp'|'repeat'|'mirror'; default 'repeat'): What is beyond its edges.
---@field flip_u? boolean flip_u (true or false; default false): Whether left and right are exchanged.
---@field tiles? number|number[] tiles (a number or a table of 2 numbers; default 1): How many lie side by side: one number, or {across, up}.
---@field offset? number|number[] offset (a number or a table of 2 numbers; default 0): How far it is moved, in pictures: {across, up}.
---@field channel? 'kd'|'ks'|'emission'|'opacity' channel ('kd'|'ks'|'emission'|'opacity'; default 'kd'): What the image says; where opacity is below 1 the surface has holes.

---An image by the shape's own coordinates, over another material.
---@param material gr.material material (a material): The material below.
---@param image string|gr.texture image (the name of a picture file or a texture): A PNG or JPEG file, or a texture.
---@return gr.material
---@overload fun(fields: gr.image_material.fields): gr.material
function gr.image_material(material, image) end

---@class gr.bump_material.fields
---@field material gr.material material (a material): The material below.
---@field image string|gr.texture image (the name of a picture file or a texture): A PNG or JPEG file, or what gr.bump made.
---@field filter? 'nearest'|'bilinear'|'mipmap' filter ('nearest'|'bilinear'|'mipmap'; default 'mipmap'): How the image is looked up.
---@field wrap? 'clamp'|'repeat'|'mirror' wrap ('clamp'|'repeat'|'mirror'; default 'repeat'): What is beyond its edges.
---@field flip_u? boolean flip_u (true or false; default false): Whether left and right are exchanged.
---@field tiles? number|number[] tiles (a number or a table of 2 numbers; default 1): How many lie side by side: one number, or {across, up}.
---@field offset? number|number[] offset (a number or a table of 2 numbers; default 0): How far it is moved, in pictures: {across, up}.
---@field height? number height (a number; default 1/50 of the picture's size; 1 for normals): White over black in units of the object; of normals, a factor of their slopes.
---@field kind? 'bump'|'normal' kind ('bump'|'normal'; default 'bump'): Whether it holds heights, or normals as colours: x right, y up, z out.

---A bump map or normal map over another material.
---@param material gr.material material (a material): The material below.
---@param image string|gr.texture image (the name of a picture file or a texture): A PNG or JPEG file, or what gr.bump made.
---@param height? number height (a number; default 1/50 of the picture's size; 1 for normals): White over black in units of the object; of normals, a factor of their slopes.
---@return gr.material
---@overload fun(fields: gr.bump_material.fields): gr.material
function gr.bump_material(material, image, height) end

---@class gr.glyphs.fields
---@field font string font (the name of a file): A font file: TrueType, OpenType or Type 1.
---@field text string text (a string): One line of text, in UTF-8.

---Outlines of a line of text in ems: letters with code, x, advance, missing, contours (cubic, as gr.prism takes them); width, ascender, descender, line.
---@param font string font (the name of a file): A font file: TrueType, OpenType or Type 1.
---@param text string text (a string): One line of text, in UTF-8.
---@return table
---@overload fun(fields: gr.glyphs.fields): table
function gr.glyphs(font, text) end

---@class gr.light.fields
---@field colour gr.triple colour (a colour {r, g, b}): Its colour and strength.
---@field include? gr.node[] include (a table of nodes; default all): The nodes that it lights, with everything under them.
---@field exclude? gr.node[] exclude (a table of nodes; default none): The nodes that it does not light.
---@field falloff? gr.triple falloff (a table of 3 numbers; default {1, 0, 0}): Coefficients: light is divided by c0 + c1 d + c2 d^2.
---@field range? number range (a number, > 0; optional): How far it reaches, instead of falloff: light is multiplied by 1 - d / range.
---@field intensity? number intensity (a number, >= 0; optional): Physical fading, instead of falloff: light is multiplied by intensity / d^2.
---@field position gr.triple position (a point {x, y, z}): Where it stands.

---A light at a point.
---@param position gr.triple position (a point {x, y, z}): Where it stands.
---@param colour gr.triple colour (a colour {r, g, b}): Its colour and strength.
---@param falloff? gr.triple falloff (a table of 3 numbers; default {1, 0, 0}): Coefficients: light is divided by c0 + c1 d + c2 d^2.
---@return gr.light
---@overload fun(fields: gr.light.fields): gr.light
function gr.light(position, colour, falloff) end

---@class gr.area_light.fields
---@field colour? gr.triple colour (a colour {r, g, b}; default {1, 1, 1} with emission): Its colour and strength.
---@field include? gr.node[] include (a table of nodes; default all): The nodes that it lights, with everything under them.
---@field exclude? gr.node[] exclude (a table of nodes; default none): The nodes that it does not light.
---@field falloff? gr.triple falloff (a table of 3 numbers; default {1, 0, 0}): Coefficients: light is divided by c0 + c1 d + c2 d^2.
---@field range? number range (a number, > 0; optional): How far it reaches, instead of falloff: light is multiplied by 1 - d / range.
---@field intensity? number intensity (a number, >= 0; optional): Physical fading, instead of falloff: light is multiplied by intensity / d^2.
---@field emission? gr.triple emission (a colour {r, g, b}; optional): Radiance of its surface, times colour: what it lights follows its true shape, without falloff.
---@field samples? integer samples (a whole number, 1 to 64; default area_samples): N x N shadow rays for this light.
---@field visible? boolean visible (true or false; default false): Whether the light itself is seen.
---@field corner gr.triple corner (a point {x, y, z}): One corner of the parallelogram.
---@field v1 gr.triple v1 (a direction {x, y, z}): The edge to the next corner.
---@field v2 gr.triple v2 (a direction {x, y, z}): The edge to the corner on the other side.
---@field one_sided? boolean one_sided (true or false; default false): Whether it is seen, and emits, only on the side of v1 x v2.

---A light that is a parallelogram; soft shadows.
---@param corner gr.triple corner (a point {x, y, z}): One corner of the parallelogram.
---@param v1 gr.triple v1 (a direction {x, y, z}): The edge to the next corner.
---@param v2 gr.triple v2 (a direction {x, y, z}): The edge to the corner on the other side.
---@param colour gr.triple colour (a colour {r, g, b}; default {1, 1, 1} with emission): Its colour and strength.
---@param falloff? gr.triple falloff (a table of 3 numbers; default {1, 0, 0}): Coefficients: light is divided by c0 + c1 d + c2 d^2.
---@return gr.light
---@overload fun(fields: gr.area_light.fields): gr.light
function gr.area_light(corner, v1, v2, colour, falloff) end

---@class gr.spherical_light.fields
---@field colour? gr.triple colour (a colour {r, g, b}; default {1, 1, 1} with emission): Its colour and strength.
---@field include? gr.node[] include (a table of nodes; default all): The nodes that it lights, with everything under them.
---@field exclude? gr.node[] exclude (a table of nodes; default none): The nodes that it does not light.
---@field falloff? gr.triple falloff (a table of 3 numbers; default {1, 0, 0}): Coefficients: light is divided by c0 + c1 d + c2 d^2.
---@field range? number range (a number, > 0; optional): How far it reaches, instead of falloff: light is multiplied by 1 - d / range.
---@field intensity? number intensity (a number, >= 0; optional): Physical fading, instead of falloff: light is multiplied by intensity / d^2.
---@field emission? gr.triple emission (a colour {r, g, b}; optional): Radiance of its surface, times colour: what it lights follows its true shape, without falloff.
---@field samples? integer samples (a whole number, 1 to 64; default area_samples): N x N shadow rays for this light.
---@field visible? boolean visible (true or false; default false): Whether the light itself is seen.
---@field position gr.triple position (a point {x, y, z}): Its centre.
---@field radius number radius (a number, > 0): Its radius.

---A light that is a sphere; soft shadows.
---@param position gr.triple position (a point {x, y, z}): Its centre.
---@param colour gr.triple colour (a colour {r, g, b}; default {1, 1, 1} with emission): Its colour and strength.
---@param falloff gr.triple falloff (a table of 3 numbers; default {1, 0, 0}): Coefficients: light is divided by c0 + c1 d + c2 d^2.
---@param radius number radius (a number, > 0): Its radius.
---@return gr.light
---@overload fun(fields: gr.spherical_light.fields): gr.light
function gr.spherical_light(position, colour, falloff, radius) end

---@class gr.disc_light.fields
---@field colour? gr.triple colour (a colour {r, g, b}; default {1, 1, 1} with emission): Its colour and strength.
---@field include? gr.node[] include (a table of nodes; default all): The nodes that it lights, with everything under them.
---@field exclude? gr.node[] exclude (a table of nodes; default none): The nodes that it does not light.
---@field falloff? gr.triple falloff (a table of 3 numbers; default {1, 0, 0}): Coefficients: light is divided by c0 + c1 d + c2 d^2.
---@field range? number range (a number, > 0; optional): How far it reaches, instead of falloff: light is multiplied by 1 - d / range.
---@field intensity? number intensity (a number, >= 0; optional): Physical fading, instead of falloff: light is multiplied by intensity / d^2.
---@field emission? gr.triple emission (a colour {r, g, b}; optional): Radiance of its surface, times colour: what it lights follows its true shape, without falloff.
---@field samples? integer samples (a whole number, 1 to 64; default area_samples): N x N shadow rays for this light.
---@field visible? boolean visible (true or false; default false): Whether the light itself is seen.
---@field position gr.triple position (a point {x, y, z}): Its centre.
---@field normal gr.triple normal (a direction {x, y, z}): The direction it faces.
---@field radius number radius (a number, > 0): Its radius.
---@field one_sided? boolean one_sided (true or false; default false): Whether it is seen, and emits, only on the side of its normal.

---A light that is a disc; soft shadows.
---@param position gr.triple position (a point {x, y, z}): Its centre.
---@param normal gr.triple normal (a direction {x, y, z}): The direction it faces.
---@param radius number radius (a number, > 0): Its radius.
---@param colour gr.triple colour (a colour {r, g, b}; default {1, 1, 1} with emission): Its colour and strength.
---@param falloff? gr.triple falloff (a table of 3 numbers; default {1, 0, 0}): Coefficients: light is divided by c0 + c1 d + c2 d^2.
---@return gr.light
---@overload fun(fields: gr.disc_light.fields): gr.light
function gr.disc_light(position, normal, radius, colour, falloff) end

---@class gr.directional_light.fields
---@field colour gr.triple colour (a colour {r, g, b}): Its colour and strength.
---@field include? gr.node[] include (a table of nodes; default all): The nodes that it lights, with everything under them.
---@field exclude? gr.node[] exclude (a table of nodes; default none): The nodes that it does not light.
---@field direction gr.triple direction (a direction {x, y, z}): The direction its light goes in.

---Light of one direction from infinitely far away.
---@param direction gr.triple direction (a direction {x, y, z}): The direction its light goes in.
---@param colour gr.triple colour (a colour {r, g, b}): Its colour and strength.
---@return gr.light
---@overload fun(fields: gr.directional_light.fields): gr.light
function gr.directional_light(direction, colour) end

---@class gr.spot_light.fields
---@field colour gr.triple colour (a colour {r, g, b}): Its colour and strength.
---@field include? gr.node[] include (a table of nodes; default all): The nodes that it lights, with everything under them.
---@field exclude? gr.node[] exclude (a table of nodes; default none): The nodes that it does not light.
---@field falloff? gr.triple falloff (a table of 3 numbers; default {1, 0, 0}): Coefficients: light is divided by c0 + c1 d + c2 d^2.
---@field range? number range (a number, > 0; optional): How far it reaches, instead of falloff: light is multiplied by 1 - d / range.
---@field intensity? number intensity (a number, >= 0; optional): Physical fading, instead of falloff: light is multiplied by intensity / d^2.
---@field position gr.triple position (a point {x, y, z}): Where it stands.
---@field direction? gr.triple direction (a direction {x, y, z}; default {0, -1, 0}): The axis of its cone.
---@field target? gr.triple target (a point {x, y, z}; optional): A point on the axis, instead of direction.
---@field inner? number inner (a number, 0 to 180, in degrees; default three quarters of outer): Angle from the axis up to which its light is full.
---@field outer? number outer (a number, > 0 and <= 180, in degrees; default 30, or inner if that is more): Angle from the axis where its light ends.

---A light at a point that shines into a cone.
---@param position gr.triple position (a point {x, y, z}): Where it stands.
---@param direction gr.triple direction (a direction {x, y, z}; default {0, -1, 0}): The axis of its cone.
---@param colour gr.triple colour (a colour {r, g, b}): Its colour and strength.
---@param inner number inner (a number, 0 to 180, in degrees; default three quarters of outer): Angle from the axis up to which its light is full.
---@param outer number outer (a number, > 0 and <= 180, in degrees; default 30, or inner if that is more): Angle from the axis where its light ends.
---@param falloff? gr.triple falloff (a table of 3 numbers; default {1, 0, 0}): Coefficients: light is divided by c0 + c1 d + c2 d^2.
---@return gr.light
---@overload fun(fields: gr.spot_light.fields): gr.light
function gr.spot_light(position, direction, colour, inner, outer, falloff) end

---@class gr.mesh_light.fields
---@field colour? gr.triple colour (a colour {r, g, b}; default {1, 1, 1} with emission): Its colour and strength.
---@field include? gr.node[] include (a table of nodes; default all): The nodes that it lights, with everything under them.
---@field exclude? gr.node[] exclude (a table of nodes; default none): The nodes that it does not light.
---@field emission? gr.triple emission (a colour {r, g, b}; default its materials'): Radiance of its surface, times colour.
---@field samples? integer samples (a whole number, 1 to 64; default area_samples): N x N shadow rays for this light.
---@field mesh gr.node mesh (a node): A mesh, or a node with meshes below; it shines wherever the scene shows it, and unseen where its own transforms put it when the scene does not.

---Light from the triangles of a mesh, as bright as they look.
---@param mesh gr.node mesh (a node): A mesh, or a node with meshes below; it shines wherever the scene shows it, and unseen where its own transforms put it when the scene does not.
---@param emission? gr.triple emission (a colour {r, g, b}; default its materials'): Radiance of its surface, times colour.
---@return gr.light
---@overload fun(fields: gr.mesh_light.fields): gr.light
function gr.mesh_light(mesh, emission) end

---@class gr.sky_light.fields
---@field colour? gr.triple colour (a colour {r, g, b}; default {1, 1, 1} with emission): Its colour and strength.
---@field include? gr.node[] include (a table of nodes; default all): The nodes that it lights, with everything under them.
---@field exclude? gr.node[] exclude (a table of nodes; default none): The nodes that it does not light.
---@field sky gr.triple|gr.sky|'gradient' sky (a colour {r, g, b}, a sky or 'gradient'): A sky, one colour all around, or 'gradient'.
---@field samples? integer samples (a whole number, 1 to 64; default area_samples): N x N shadow rays for this light.

---Light from all of a sky; more shadow rays go where it is bright.
---@param sky gr.triple|gr.sky|'gradient' sky (a colour {r, g, b}, a sky or 'gradient'): A sky, one colour all around, or 'gradient'.
---@return gr.light
---@overload fun(fields: gr.sky_light.fields): gr.light
function gr.sky_light(sky) end

---@class gr.change_node.fields
---@field name string name (a string): Name of the node; a node of another name is not meant.
---@field serial integer serial (a whole number, 0 to 4294967295): Which one, by order of creation: the first is 0, what was added in a window counts down from 4294967295.
---@field matrix number|number[] matrix (a number or a table of numbers): Three rows of a matrix, 12 numbers: where it goes from where its own transforms put it, in the space of its parent.

---Moves, turns or scales a node in every picture from here on, as somebody did in a window; the window writes such calls into a file for require.
---@param name string name (a string): Name of the node; a node of another name is not meant.
---@param serial integer serial (a whole number, 0 to 4294967295): Which one, by order of creation: the first is 0, what was added in a window counts down from 4294967295.
---@param matrix number|number[] matrix (a number or a table of numbers): Three rows of a matrix, 12 numbers: where it goes from where its own transforms put it, in the space of its parent.
---@overload fun(fields: gr.change_node.fields)
function gr.change_node(name, serial, matrix) end

---@class gr.change_delete.fields
---@field name string name (a string): Name of the node; a node of another name is not meant.
---@field serial integer serial (a whole number, 0 to 4294967295): Which one, by order of creation: the first is 0, what was added in a window counts down from 4294967295.

---Leaves a node and what is under it out of every picture from here on.
---@param name string name (a string): Name of the node; a node of another name is not meant.
---@param serial integer serial (a whole number, 0 to 4294967295): Which one, by order of creation: the first is 0, what was added in a window counts down from 4294967295.
---@overload fun(fields: gr.change_delete.fields)
function gr.change_delete(name, serial) end

---@class gr.change_add.fields
---@field name string name (a string): Name of the node that it goes under.
---@field serial integer serial (a whole number, 0 to 4294967295): Which one, by order of creation: the first is 0, what was added in a window counts down from 4294967295.
---@field shape 'sphere'|'cube'|'cylinder'|'cone'|'torus'|'copy' shape ('sphere'|'cube'|'cylinder'|'cone'|'torus'|'copy'): What is added, of about the size of a ball of radius 1, or a copy of a node.
---@field colour? gr.triple colour (a colour {r, g, b}; default {0.7, 0.7, 0.7}): Its colour.
---@field source? integer source (a whole number, 0 to 4294967295; default 0): For a copy: the node that is shown once more.

---Adds a node to every picture from here on; gr.change_node puts it into its place.
---@param name string name (a string): Name of the node that it goes under.
---@param serial integer serial (a whole number, 0 to 4294967295): Which one, by order of creation: the first is 0, what was added in a window counts down from 4294967295.
---@param shape 'sphere'|'cube'|'cylinder'|'cone'|'torus'|'copy' shape ('sphere'|'cube'|'cylinder'|'cone'|'torus'|'copy'): What is added, of about the size of a ball of radius 1, or a copy of a node.
---@param colour? gr.triple colour (a colour {r, g, b}; default {0.7, 0.7, 0.7}): Its colour.
---@param source? integer source (a whole number, 0 to 4294967295; default 0): For a copy: the node that is shown once more.
---@overload fun(fields: gr.change_add.fields)
function gr.change_add(name, serial, shape, colour, source) end

---@class gr.change_material.fields
---@field serial integer serial (a whole number, 0 to 4294967295): Which one, by order of creation: the first is 1.
---@field colour gr.triple colour (a colour {r, g, b}): The new diffuse colour of its base.

---Gives a material another colour in every picture from here on.
---@param serial integer serial (a whole number, 0 to 4294967295): Which one, by order of creation: the first is 1.
---@param colour gr.triple colour (a colour {r, g, b}): The new diffuse colour of its base.
---@overload fun(fields: gr.change_material.fields)
function gr.change_material(serial, colour) end

---@class gr.change_look.fields
---@field serial integer serial (a whole number, 0 to 4294967295): Which material, by order of creation: the first is 1.
---@field part 'kd'|'ks'|'shininess'|'reflect'|'roughness'|'refract'|'ior'|'emission'|'absorption' part ('kd'|'ks'|'shininess'|'reflect'|'roughness'|'refract'|'ior'|'emission'|'absorption'): What of its base, by the name that gr.material has for it.
---@field value number|number[] value (a number or a table of numbers): Three numbers for a colour, else one.

---Changes any part of the base of a material in every picture from here on.
---@param serial integer serial (a whole number, 0 to 4294967295): Which material, by order of creation: the first is 1.
---@param part 'kd'|'ks'|'shininess'|'reflect'|'roughness'|'refract'|'ior'|'emission'|'absorption' part ('kd'|'ks'|'shininess'|'reflect'|'roughness'|'refract'|'ior'|'emission'|'absorption'): What of its base, by the name that gr.material has for it.
---@param value number|number[] value (a number or a table of numbers): Three numbers for a colour, else one.
---@overload fun(fields: gr.change_look.fields)
function gr.change_look(serial, part, value) end

---@class gr.change_own.fields
---@field name string name (a string): Name of the node; a node of another name is not meant.
---@field serial integer serial (a whole number, 0 to 4294967295): Which one, by order of creation: the first is 0, what was added in a window counts down from 4294967295.
---@field like? integer like (a whole number, 0 to 4294967295; default 0): A material by order of creation, for a shape that has none itself; 0: plain gray.

---Gives a shape a material of its own in every picture from here on: a copy of the one it has. The first is numbered 2147483647, the next ones count down.
---@param name string name (a string): Name of the node; a node of another name is not meant.
---@param serial integer serial (a whole number, 0 to 4294967295): Which one, by order of creation: the first is 0, what was added in a window counts down from 4294967295.
---@param like? integer like (a whole number, 0 to 4294967295; default 0): A material by order of creation, for a shape that has none itself; 0: plain gray.
---@overload fun(fields: gr.change_own.fields)
function gr.change_own(name, serial, like) end

---@class gr.change_light.fields
---@field number integer number (a whole number, 1 to 4294967295): Its place in the list of gr.render, from 1.
---@field move gr.triple move (a table of 3 numbers): The way it is moved.
---@field factor? gr.triple factor (a table of 3 numbers; default {1, 1, 1}): What its colour is multiplied by.
---@field linear? number|number[] linear (a number or a table of numbers; default none): Three rows of a matrix, 9 numbers: how it is turned and sized about its place.
---@field colour? gr.triple colour (a colour {r, g, b}; default its own): Another colour, before it is multiplied.

---Moves a light of every picture from here on, turns it and makes it larger or smaller, brighter or darker.
---@param number integer number (a whole number, 1 to 4294967295): Its place in the list of gr.render, from 1.
---@param move gr.triple move (a table of 3 numbers): The way it is moved.
---@param factor? gr.triple factor (a table of 3 numbers; default {1, 1, 1}): What its colour is multiplied by.
---@param linear? number|number[] linear (a number or a table of numbers; default none): Three rows of a matrix, 9 numbers: how it is turned and sized about its place.
---@param colour? gr.triple colour (a colour {r, g, b}; default its own): Another colour, before it is multiplied.
---@overload fun(fields: gr.change_light.fields)
function gr.change_light(number, move, factor, linear, colour) end

---@class gr.change_delete_light.fields
---@field number integer number (a whole number, 1 to 4294967295): Its place in the list of gr.render, from 1.

---Takes a light away from every picture from here on.
---@param number integer number (a whole number, 1 to 4294967295): Its place in the list of gr.render, from 1.
---@overload fun(fields: gr.change_delete_light.fields)
function gr.change_delete_light(number) end

---@class gr.change_add_light.fields
---@field position gr.triple position (a point {x, y, z}): Where it is.
---@field colour gr.triple colour (a colour {r, g, b}): Its colour.

---Adds a point light to every picture from here on.
---@param position gr.triple position (a point {x, y, z}): Where it is.
---@param colour gr.triple colour (a colour {r, g, b}): Its colour.
---@overload fun(fields: gr.change_add_light.fields)
function gr.change_add_light(position, colour) end

---@class gr.change_copy_light.fields
---@field number integer number (a whole number, 1 to 4294967295): Its place in the list of gr.render, from 1.
---@field move gr.triple move (a table of 3 numbers): How far the copy stands from it.
---@field factor? gr.triple factor (a table of 3 numbers; default {1, 1, 1}): What the copy's colour is multiplied by.

---Adds a copy of a light to every picture from here on.
---@param number integer number (a whole number, 1 to 4294967295): Its place in the list of gr.render, from 1.
---@param move gr.triple move (a table of 3 numbers): How far the copy stands from it.
---@param factor? gr.triple factor (a table of 3 numbers; default {1, 1, 1}): What the copy's colour is multiplied by.
---@overload fun(fields: gr.change_copy_light.fields)
function gr.change_copy_light(number, move, factor) end

---@class gr.change_view.fields
---@field picture string picture (a string): The picture that it is for, by the name that gr.render gives it.
---@field eye gr.triple eye (a point {x, y, z}): Where the camera is.
---@field view gr.triple view (a direction {x, y, z}): The direction it looks in.
---@field up gr.triple up (a direction {x, y, z}): What is up in the picture.
---@field fov number fov (a number, > 0 and < 180, in degrees): Its full vertical angle.

---Gives a picture another camera.
---@param picture string picture (a string): The picture that it is for, by the name that gr.render gives it.
---@param eye gr.triple eye (a point {x, y, z}): Where the camera is.
---@param view gr.triple view (a direction {x, y, z}): The direction it looks in.
---@param up gr.triple up (a direction {x, y, z}): What is up in the picture.
---@param fov number fov (a number, > 0 and < 180, in degrees): Its full vertical angle.
---@overload fun(fields: gr.change_view.fields)
function gr.change_view(picture, eye, view, up, fov) end

---@class gr.change_exposure.fields
---@field picture string picture (a string): The picture that it is for, by the name that gr.render gives it.
---@field stops number stops (a number, >= -100 and <= 100, in stops): Its exposure in the place of what the script says.

---Gives a picture another exposure.
---@param picture string picture (a string): The picture that it is for, by the name that gr.render gives it.
---@param stops number stops (a number, >= -100 and <= 100, in stops): Its exposure in the place of what the script says.
---@overload fun(fields: gr.change_exposure.fields)
function gr.change_exposure(picture, stops) end

---@class gr.sun_light.fields
---@field colour gr.triple colour (a colour {r, g, b}): Its colour and strength.
---@field include? gr.node[] include (a table of nodes; default all): The nodes that it lights, with everything under them.
---@field exclude? gr.node[] exclude (a table of nodes; default none): The nodes that it does not light.
---@field sun? gr.triple sun (a direction {x, y, z}; optional): The direction to the sun, instead of time and place.
---@field hour? number hour (a number, 0 to 24; default 12): Hour of the clock.
---@field day? integer day (a whole number, 1 to 366; default 172, 21 June): Day of the year.
---@field latitude? number latitude (a number, >= -90 and <= 90, in degrees; default 45): North is positive; -z is north and +x is east.
---@field longitude? number longitude (a number, >= -180 and <= 180, in degrees; default 0): East is positive.
---@field zone? number zone (a number, >= -14 and <= 14, in hours; default 0): How far the clock is ahead of Greenwich.

---Directional light from where the sun stands.
---@param sun gr.triple sun (a direction {x, y, z}; optional): The direction to the sun, instead of time and place.
---@param colour gr.triple colour (a colour {r, g, b}): Its colour and strength.
---@return gr.light
---@overload fun(fields: gr.sun_light.fields): gr.light
function gr.sun_light(sun, colour) end

---@class gr.sky_faces.fields
---@field intensity? number intensity (a number, >= 0; default 1): Factor of its brightness.
---@field rotation? number rotation (a number, in degrees; default 0): How far it is turned about y, counterclockwise seen from above.
---@field front string|gr.texture front (the name of a picture file or a texture): A square picture, as somebody in the middle sees it.
---@field right string|gr.texture right (the name of a picture file or a texture): A square picture, as somebody in the middle sees it.
---@field back string|gr.texture back (the name of a picture file or a texture): A square picture, as somebody in the middle sees it.
---@field left string|gr.texture left (the name of a picture file or a texture): A square picture, as somebody in the middle sees it.
---@field top string|gr.texture top (the name of a picture file or a texture): A square picture, as somebody in the middle sees it.
---@field bottom string|gr.texture bottom (the name of a picture file or a texture): A square picture, as somebody in the middle sees it.

---A sky of six pictures on a cube: front is +z, right -x, back -z, left +x.
---@param front string|gr.texture front (the name of a picture file or a texture): A square picture, as somebody in the middle sees it.
---@param right string|gr.texture right (the name of a picture file or a texture): A square picture, as somebody in the middle sees it.
---@param back string|gr.texture back (the name of a picture file or a texture): A square picture, as somebody in the middle sees it.
---@param left string|gr.texture left (the name of a picture file or a texture): A square picture, as somebody in the middle sees it.
---@param top string|gr.texture top (the name of a picture file or a texture): A square picture, as somebody in the middle sees it.
---@param bottom string|gr.texture bottom (the name of a picture file or a texture): A square picture, as somebody in the middle sees it.
---@return gr.sky
---@overload fun(fields: gr.sky_faces.fields): gr.sky
function gr.sky_faces(front, right, back, left, top, bottom) end

---@class gr.sky_cross.fields
---@field intensity? number intensity (a number, >= 0; default 1): Factor of its brightness.
---@field rotation? number rotation (a number, in degrees; default 0): How far it is turned about y, counterclockwise seen from above.
---@field image string|gr.texture image (the name of a picture file or a texture): A 4 x 3 cross of images all around, as a picture file.
---@field mirror? boolean mirror (true or false; default false): Whether the cross is mirrored.

---A sky from a 4 x 3 cross of images.
---@param image string|gr.texture image (the name of a picture file or a texture): A 4 x 3 cross of images all around, as a picture file.
---@return gr.sky
---@overload fun(fields: gr.sky_cross.fields): gr.sky
function gr.sky_cross(image) end

---@class gr.sky_map.fields
---@field intensity? number intensity (a number, >= 0; default 1): Factor of its brightness.
---@field rotation? number rotation (a number, in degrees; default 0): How far it is turned about y, counterclockwise seen from above.
---@field image string|gr.texture image (the name of a picture file or a texture): The whole sphere, longitude by latitude; -z is in its middle, +x right of it. Radiance HDR, PFM and EXR files hold light of any brightness.

---A sky from one picture of the whole sphere.
---@param image string|gr.texture image (the name of a picture file or a texture): The whole sphere, longitude by latitude; -z is in its middle, +x right of it. Radiance HDR, PFM and EXR files hold light of any brightness.
---@return gr.sky
---@overload fun(fields: gr.sky_map.fields): gr.sky
function gr.sky_map(image) end

---@class gr.sky_gradient.fields
---@field intensity? number intensity (a number, >= 0; default 1): Factor of its brightness.
---@field rotation? number rotation (a number, in degrees; default 0): How far it is turned about y, counterclockwise seen from above.
---@field stops number[][] stops (a table of stops {height, r, g, b}): Colours by height, {y, r, g, b}: y of the unit direction, from -1 to 1.

---A sky of colours by height.
---@param stops number[][] stops (a table of stops {height, r, g, b}): Colours by height, {y, r, g, b}: y of the unit direction, from -1 to 1.
---@return gr.sky
---@overload fun(fields: gr.sky_gradient.fields): gr.sky
function gr.sky_gradient(stops) end

---@class gr.clear_sky.fields
---@field intensity? number intensity (a number, >= 0; default 1): Factor of its brightness.
---@field rotation? number rotation (a number, in degrees; default 0): How far it is turned about y, counterclockwise seen from above.
---@field sun? gr.triple sun (a direction {x, y, z}; optional): The direction to the sun, instead of time and place.
---@field hour? number hour (a number, 0 to 24; default 12): Hour of the clock.
---@field day? integer day (a whole number, 1 to 366; default 172, 21 June): Day of the year.
---@field latitude? number latitude (a number, >= -90 and <= 90, in degrees; default 45): North is positive; -z is north and +x is east.
---@field longitude? number longitude (a number, >= -180 and <= 180, in degrees; default 0): East is positive.
---@field zone? number zone (a number, >= -14 and <= 14, in hours; default 0): How far the clock is ahead of Greenwich.
---@field turbidity? number turbidity (a number, 1.7 to 10; default 2.5): How hazy the air is: 2 is very clear, 10 hazy.
---@field ground? gr.triple ground (a colour {r, g, b}; default {0.15, 0.15, 0.15}): What is below the horizon.

---The physical clear sky of Preetham, Shirley and Smits, 1999.
---@param sun gr.triple sun (a direction {x, y, z}; optional): The direction to the sun, instead of time and place.
---@param turbidity? number turbidity (a number, 1.7 to 10; default 2.5): How hazy the air is: 2 is very clear, 10 hazy.
---@return gr.sky
---@overload fun(fields: gr.clear_sky.fields): gr.sky
function gr.clear_sky(sun, turbidity) end

---@class gr.uniform_fog.fields
---@field colour? gr.triple colour (a colour {r, g, b}; default {0.5, 0.5, 0.5}): Its colour.
---@field clear_sky? boolean clear_sky (true or false; default false): Whether the sky is seen without fog.
---@field density number density (a number, >= 0): What is d away keeps the share exp(-density d).
---@field squared? boolean squared (true or false; default false): The share is exp(-(density d)^2) instead: clear near, then closing fast.

---Fog that is the same everywhere.
---@param density number density (a number, >= 0): What is d away keeps the share exp(-density d).
---@param colour? gr.triple colour (a colour {r, g, b}; default {0.5, 0.5, 0.5}): Its colour.
---@return gr.fog
---@overload fun(fields: gr.uniform_fog.fields): gr.fog
function gr.uniform_fog(density, colour) end

---@class gr.linear_fog.fields
---@field colour? gr.triple colour (a colour {r, g, b}; default {0.5, 0.5, 0.5}): Its colour.
---@field clear_sky? boolean clear_sky (true or false; default false): Whether the sky is seen without fog.
---@field near? number near (a number, >= 0; default 0): Where it begins.
---@field far number far (a number, > 0): Where nothing else is seen any more.

---Fog that closes linearly with distance.
---@param near number near (a number, >= 0; default 0): Where it begins.
---@param far number far (a number, > 0): Where nothing else is seen any more.
---@param colour? gr.triple colour (a colour {r, g, b}; default {0.5, 0.5, 0.5}): Its colour.
---@return gr.fog
---@overload fun(fields: gr.linear_fog.fields): gr.fog
function gr.linear_fog(near, far, colour) end

---@class gr.height_fog.fields
---@field colour? gr.triple colour (a colour {r, g, b}; default {0.5, 0.5, 0.5}): Its colour.
---@field clear_sky? boolean clear_sky (true or false; default false): Whether the sky is seen without fog.
---@field density number density (a number, >= 0): Density at the base.
---@field base? number base (a number; default 0): Height y of the base.
---@field scale? number scale (a number, > 0; default 1): How much higher it is thinner by the factor e.

---Fog that thins out upwards.
---@param density number density (a number, >= 0): Density at the base.
---@param base number base (a number; default 0): Height y of the base.
---@param scale number scale (a number, > 0; default 1): How much higher it is thinner by the factor e.
---@param colour? gr.triple colour (a colour {r, g, b}; default {0.5, 0.5, 0.5}): Its colour.
---@return gr.fog
---@overload fun(fields: gr.height_fog.fields): gr.fog
function gr.height_fog(density, base, scale, colour) end

---@class gr.fog_profile.fields
---@field colour? gr.triple colour (a colour {r, g, b}; default {0.5, 0.5, 0.5}): Its colour.
---@field clear_sky? boolean clear_sky (true or false; default false): Whether the sky is seen without fog.
---@field profile number[][] profile (a table of pairs {u, v}): Densities by height, {y, density}; linear between, constant beyond.

---Fog with a density for every height.
---@param profile number[][] profile (a table of pairs {u, v}): Densities by height, {y, density}; linear between, constant beyond.
---@param colour? gr.triple colour (a colour {r, g, b}; default {0.5, 0.5, 0.5}): Its colour.
---@return gr.fog
---@overload fun(fields: gr.fog_profile.fields): gr.fog
function gr.fog_profile(profile, colour) end

---@class gr.fog_grid.fields
---@field colour? gr.triple colour (a colour {r, g, b}; default {0.5, 0.5, 0.5}): Its colour.
---@field clear_sky? boolean clear_sky (true or false; default false): Whether the sky is seen without fog.
---@field corner gr.triple corner (a point {x, y, z}): The corner with the smallest coordinates.
---@field size number|gr.triple size (a number or a table of 3 numbers, > 0): Length of the edges, one number or three.
---@field cells gr.triple cells (a table of 3 numbers, 1 to 1024): How many cells along x, y and z.
---@field densities number|number[] densities (a number or a table of numbers, >= 0): The density of each cell, x running fastest, then y, then z.

---Fog in the cells of a box, none outside.
---@param corner gr.triple corner (a point {x, y, z}): The corner with the smallest coordinates.
---@param size number|gr.triple size (a number or a table of 3 numbers, > 0): Length of the edges, one number or three.
---@param cells gr.triple cells (a table of 3 numbers, 1 to 1024): How many cells along x, y and z.
---@param densities number|number[] densities (a number or a table of numbers, >= 0): The density of each cell, x running fastest, then y, then z.
---@param colour? gr.triple colour (a colour {r, g, b}; default {0.5, 0.5, 0.5}): Its colour.
---@return gr.fog
---@overload fun(fields: gr.fog_grid.fields): gr.fog
function gr.fog_grid(corner, size, cells, densities, colour) end

---@class gr.render.fields
---@field node gr.node node (a node): The root of what is drawn.
---@field file string file (the name of a file): The picture to write: .png, or .pfm, .hdr or .exr for linear light; missing folders are made.
---@field sky? string|gr.texture sky (the name of a picture file or a texture; optional): A 4 x 3 cross of images all around, as a PNG or JPEG file.
---@field width integer width (a whole number, 1 to 1048576, in pixels): Width of the picture.
---@field height integer height (a whole number, 1 to 1048576, in pixels): Height of the picture.
---@field eye gr.triple eye (a point {x, y, z}): Where the camera stands.
---@field view? gr.triple view (a direction {x, y, z}; default {0, 0, -1}): The direction it looks in.
---@field up? gr.triple up (a direction {x, y, z}; default {0, 1, 0}): The direction that is up in the picture.
---@field fov? number fov (a number, > 0 and < 180, in degrees; default 50): The full vertical angle of view.
---@field ambient? gr.triple ambient (a colour {r, g, b}; default {0, 0, 0}): Light that is everywhere.
---@field lights? gr.light[] lights (a table of lights; default {}): A table of lights.
---@field target? gr.triple target (a point {x, y, z}; optional): A point to look at, instead of view.
---@field background? gr.triple|gr.sky|'gradient' background (a colour {r, g, b}, a sky or 'gradient'; default 'gradient'): What rays see that meet nothing: a colour, a sky, or 'gradient' for {0, 0, (1 + y)/2}.
---@field mirror? boolean mirror (true or false; default false): Whether the sky cross is mirrored.
---@field samples? integer samples (a whole number, 1 to 64; default -ss): N x N samples for a marked pixel.
---@field full? boolean full (true or false; default -full): Whether every pixel is sampled so.
---@field area_samples? integer area_samples (a whole number, 1 to 64; default -al-samples): N x N shadow rays for an area light.
---@field reflect_limit? integer reflect_limit (a whole number, 0 to 1000; default -reflect-limit): How often a path may reflect.
---@field refract_limit? integer refract_limit (a whole number, 0 to 1000; default -refract-limit): How often a path may refract.
---@field side_tolerance? number side_tolerance (a number, >= 0; default -side-tolerance): Squared distance of colours between side neighbours that marks a pixel.
---@field corner_tolerance? number corner_tolerance (a number, >= 0; default -corner-tolerance): The same between corner neighbours.
---@field use_tir? boolean use_tir (true or false; default -use-tir): Whether light beyond the critical angle is reflected.
---@field specular? 'phong'|'blinn' specular ('phong'|'blinn'; default --specular): The form of highlights.
---@field seed? integer seed (a whole number, 0 to 9.00719925474099e+15; default --seed): Start of random numbers.
---@field accel? 'auto'|'grid'|'bvh'|'kdtree'|'none' accel ('auto'|'grid'|'bvh'|'kdtree'|'none'; default 'auto'): How hits are searched; the picture is the same.
---@field fog? gr.fog fog (a fog; default none): A fog.
---@field caustics? integer|{photons?: integer, radius?: number} caustics (a number of photons or {photons = ..., radius = ...}; default --caustics): Light that glass and mirrors throw: how many photons are sent (200000), and the radius of what each lights (by their density).
---@field cutoff? number cutoff (a number, 0 to 1; default --cutoff): Rays that can change a pixel by less than this are not followed.
---@field exposure? number exposure (a number, >= -100 and <= 100, in stops; default --exposure): Light is multiplied by 2^exposure on its way into a PNG file.
---@field tone? 'none'|'reinhard'|'filmic' tone ('none'|'reinhard'|'filmic'; default --tone): The curve that brings bright light into the range of a PNG file.
---@field srgb? boolean srgb (true or false; default --srgb): Whether values of a PNG file follow the sRGB transfer function.
---@field deep? boolean deep (true or false; default --deep): Whether a PNG file has 16 bits a channel.
---@field projection? 'perspective'|'orthographic'|'fisheye'|'panorama' projection ('perspective'|'orthographic'|'fisheye'|'panorama'; default 'perspective'): Fisheye is equidistant inside a circle; panorama is all around, longitude by latitude.
---@field view_height? number view_height (a number, > 0; default 2): Height of an orthographic picture in the scene.
---@field angle? number angle (a number, > 0 and <= 360, in degrees; default 180): Full angle of a fisheye across the height.
---@field shift_x? number shift_x (a number, in widths; default 0): How far the window is off to the right.
---@field shift_y? number shift_y (a number, in heights; default 0): How far the window is off upwards.
---@field aperture? number aperture (a number, >= 0; default 0): Radius of the lens in the scene; 0 is a pinhole. With a lens every pixel is resampled.
---@field focus? number focus (a number, > 0; default target, else 1): Distance of the plane that is sharp, along the view.
---@field focus_point? gr.triple focus_point (a point {x, y, z}; optional): A point of that plane, instead of focus.
---@field blades? integer blades (a whole number, 3 to 64; default round): Number of blades: the aperture is a polygon.
---@field blade_angle? number blade_angle (a number, in degrees; default 0): How far that polygon is turned.
---@field stereo? 'none'|'side'|'anaglyph' stereo ('none'|'side'|'anaglyph'; default 'none'): Two eyes: pictures side by side, left one left, or red and cyan.
---@field eye_distance? number eye_distance (a number, >= 0; default screen / 30): How far the eyes are apart.
---@field screen? number screen (a number, > 0; default focus): Distance along the view that both eyes see in the same place.
---@field shutter? number[] shutter (a table of two rising numbers; default {0, 1}): When the shutter opens and closes, {open, close}; what moves meanwhile is blurred.
---@field eye_to? gr.triple eye_to (a point {x, y, z}; default eye): Where a moving camera stands at time 1.
---@field view_to? gr.triple view_to (a direction {x, y, z}; default view): The direction it looks in then.
---@field target_to? gr.triple target_to (a point {x, y, z}; default target): The point it looks at then.
---@field up_to? gr.triple up_to (a direction {x, y, z}; default up): The direction that is up then.

---Renders a picture into a PNG file.
---@param node gr.node node (a node): The root of what is drawn.
---@param file string file (the name of a file): The picture to write: .png, or .pfm, .hdr or .exr for linear light; missing folders are made.
---@param width integer width (a whole number, 1 to 1048576, in pixels): Width of the picture.
---@param height integer height (a whole number, 1 to 1048576, in pixels): Height of the picture.
---@param eye gr.triple eye (a point {x, y, z}): Where the camera stands.
---@param view gr.triple view (a direction {x, y, z}; default {0, 0, -1}): The direction it looks in.
---@param up gr.triple up (a direction {x, y, z}; default {0, 1, 0}): The direction that is up in the picture.
---@param fov number fov (a number, > 0 and < 180, in degrees; default 50): The full vertical angle of view.
---@param ambient gr.triple ambient (a colour {r, g, b}; default {0, 0, 0}): Light that is everywhere.
---@param lights gr.light[] lights (a table of lights; default {}): A table of lights.
---@overload fun(fields: gr.render.fields)
function gr.render(node, file, width, height, eye, view, up, fov, ambient, lights) end

---@class gr.render_skybox.fields
---@field node gr.node node (a node): The root of what is drawn.
---@field file string file (the name of a file): The picture to write: .png, or .pfm, .hdr or .exr for linear light; missing folders are made.
---@field sky? string|gr.texture sky (the name of a picture file or a texture; optional): A 4 x 3 cross of images all around, as a PNG or JPEG file.
---@field width integer width (a whole number, 1 to 1048576, in pixels): Width of the picture.
---@field height integer height (a whole number, 1 to 1048576, in pixels): Height of the picture.
---@field eye gr.triple eye (a point {x, y, z}): Where the camera stands.
---@field view? gr.triple view (a direction {x, y, z}; default {0, 0, -1}): The direction it looks in.
---@field up? gr.triple up (a direction {x, y, z}; default {0, 1, 0}): The direction that is up in the picture.
---@field fov? number fov (a number, > 0 and < 180, in degrees; default 50): The full vertical angle of view.
---@field ambient? gr.triple ambient (a colour {r, g, b}; default {0, 0, 0}): Light that is everywhere.
---@field lights? gr.light[] lights (a table of lights; default {}): A table of lights.
---@field target? gr.triple target (a point {x, y, z}; optional): A point to look at, instead of view.
---@field background? gr.triple|gr.sky|'gradient' background (a colour {r, g, b}, a sky or 'gradient'; default 'gradient'): What rays see that meet nothing: a colour, a sky, or 'gradient' for {0, 0, (1 + y)/2}.
---@field mirror? boolean mirror (true or false; default false): Whether the sky cross is mirrored.
---@field samples? integer samples (a whole number, 1 to 64; default -ss): N x N samples for a marked pixel.
---@field full? boolean full (true or false; default -full): Whether every pixel is sampled so.
---@field area_samples? integer area_samples (a whole number, 1 to 64; default -al-samples): N x N shadow rays for an area light.
---@field reflect_limit? integer reflect_limit (a whole number, 0 to 1000; default -reflect-limit): How often a path may reflect.
---@field refract_limit? integer refract_limit (a whole number, 0 to 1000; default -refract-limit): How often a path may refract.
---@field side_tolerance? number side_tolerance (a number, >= 0; default -side-tolerance): Squared distance of colours between side neighbours that marks a pixel.
---@field corner_tolerance? number corner_tolerance (a number, >= 0; default -corner-tolerance): The same between corner neighbours.
---@field use_tir? boolean use_tir (true or false; default -use-tir): Whether light beyond the critical angle is reflected.
---@field specular? 'phong'|'blinn' specular ('phong'|'blinn'; default --specular): The form of highlights.
---@field seed? integer seed (a whole number, 0 to 9.00719925474099e+15; default --seed): Start of random numbers.
---@field accel? 'auto'|'grid'|'bvh'|'kdtree'|'none' accel ('auto'|'grid'|'bvh'|'kdtree'|'none'; default 'auto'): How hits are searched; the picture is the same.
---@field fog? gr.fog fog (a fog; default none): A fog.
---@field caustics? integer|{photons?: integer, radius?: number} caustics (a number of photons or {photons = ..., radius = ...}; default --caustics): Light that glass and mirrors throw: how many photons are sent (200000), and the radius of what each lights (by their density).
---@field cutoff? number cutoff (a number, 0 to 1; default --cutoff): Rays that can change a pixel by less than this are not followed.
---@field exposure? number exposure (a number, >= -100 and <= 100, in stops; default --exposure): Light is multiplied by 2^exposure on its way into a PNG file.
---@field tone? 'none'|'reinhard'|'filmic' tone ('none'|'reinhard'|'filmic'; default --tone): The curve that brings bright light into the range of a PNG file.
---@field srgb? boolean srgb (true or false; default --srgb): Whether values of a PNG file follow the sRGB transfer function.
---@field deep? boolean deep (true or false; default --deep): Whether a PNG file has 16 bits a channel.
---@field projection? 'perspective'|'orthographic'|'fisheye'|'panorama' projection ('perspective'|'orthographic'|'fisheye'|'panorama'; default 'perspective'): Fisheye is equidistant inside a circle; panorama is all around, longitude by latitude.
---@field view_height? number view_height (a number, > 0; default 2): Height of an orthographic picture in the scene.
---@field angle? number angle (a number, > 0 and <= 360, in degrees; default 180): Full angle of a fisheye across the height.
---@field shift_x? number shift_x (a number, in widths; default 0): How far the window is off to the right.
---@field shift_y? number shift_y (a number, in heights; default 0): How far the window is off upwards.
---@field aperture? number aperture (a number, >= 0; default 0): Radius of the lens in the scene; 0 is a pinhole. With a lens every pixel is resampled.
---@field focus? number focus (a number, > 0; default target, else 1): Distance of the plane that is sharp, along the view.
---@field focus_point? gr.triple focus_point (a point {x, y, z}; optional): A point of that plane, instead of focus.
---@field blades? integer blades (a whole number, 3 to 64; default round): Number of blades: the aperture is a polygon.
---@field blade_angle? number blade_angle (a number, in degrees; default 0): How far that polygon is turned.
---@field stereo? 'none'|'side'|'anaglyph' stereo ('none'|'side'|'anaglyph'; default 'none'): Two eyes: pictures side by side, left one left, or red and cyan.
---@field eye_distance? number eye_distance (a number, >= 0; default screen / 30): How far the eyes are apart.
---@field screen? number screen (a number, > 0; default focus): Distance along the view that both eyes see in the same place.
---@field shutter? number[] shutter (a table of two rising numbers; default {0, 1}): When the shutter opens and closes, {open, close}; what moves meanwhile is blurred.
---@field eye_to? gr.triple eye_to (a point {x, y, z}; default eye): Where a moving camera stands at time 1.
---@field view_to? gr.triple view_to (a direction {x, y, z}; default view): The direction it looks in then.
---@field target_to? gr.triple target_to (a point {x, y, z}; default target): The point it looks at then.
---@field up_to? gr.triple up_to (a direction {x, y, z}; default up): The direction that is up then.

---The same with a sky image all around.
---@param node gr.node node (a node): The root of what is drawn.
---@param file string file (the name of a file): The picture to write: .png, or .pfm, .hdr or .exr for linear light; missing folders are made.
---@param sky string|gr.texture sky (the name of a picture file or a texture; optional): A 4 x 3 cross of images all around, as a PNG or JPEG file.
---@param width integer width (a whole number, 1 to 1048576, in pixels): Width of the picture.
---@param height integer height (a whole number, 1 to 1048576, in pixels): Height of the picture.
---@param eye gr.triple eye (a point {x, y, z}): Where the camera stands.
---@param view gr.triple view (a direction {x, y, z}; default {0, 0, -1}): The direction it looks in.
---@param up gr.triple up (a direction {x, y, z}; default {0, 1, 0}): The direction that is up in the picture.
---@param fov number fov (a number, > 0 and < 180, in degrees; default 50): The full vertical angle of view.
---@param ambient gr.triple ambient (a colour {r, g, b}; default {0, 0, 0}): Light that is everywhere.
---@param lights gr.light[] lights (a table of lights; default {}): A table of lights.
---@overload fun(fields: gr.render_skybox.fields)
function gr.render_skybox(node, file, sky, width, height, eye, view, up, fov, ambient, lights) end

---@class gr.transform_order.fields
---@field order 'new'|'old'|'separate' order ('new'|'old'|'separate'): new: calls act as they are written; old: the last call acts first; separate: scale, then rotate, then translate.

---Says how scale, rotate and translate compose in this script.
---@param order 'new'|'old'|'separate' order ('new'|'old'|'separate'): new: calls act as they are written; old: the last call acts first; separate: scale, then rotate, then translate.
---@overload fun(fields: gr.transform_order.fields)
function gr.transform_order(order) end

---Places a node under this one.
---@param node gr.node node (a node): The child; under several parents it is an instance.
---@return gr.node
function node:add_child(node) end

---The box of this node and what is under it, where its transforms have put it: smallest and largest x, y, z.
---@return number[], number[]
function node:bounds() end

---The vertices and faces of a mesh, in its own coordinates and as gr.mesh takes them.
---@return number[][], integer[][]
function node:faces() end

---Gives a shape its material.
---@param material gr.material material (a material): What its surface looks like.
---@return gr.node
function node:set_material(material) end

---Puts an image in the place of kd.
---@param texture string|gr.texture texture (the name of a picture file or a texture): A texture, or the name of a PNG or JPEG file.
---@return gr.node
function node:set_texture(texture) end

---Puts a bump map on a shape.
---@param bump string|gr.texture bump (the name of a picture file or a texture): What gr.bump made, or the name of a PNG or JPEG file.
---@return gr.node
function node:set_bump(bump) end

---Scales this node.
---@param x number x (a number): Factor along x.
---@param y number y (a number): Factor along y.
---@param z number z (a number): Factor along z.
---@return gr.node
---@overload fun(self: gr.node, vector: gr.triple): gr.node
function node:scale(x, y, z) end

---Turns this node about an axis.
---@param axis 'x'|'y'|'z' axis ('x', 'y' or 'z'): The axis, in either case.
---@param angle number angle (a number, in degrees): How far, counterclockwise seen from the axis' tip.
---@return gr.node
function node:rotate(axis, angle) end

---Lets this node move while the shutter is open; where its transforms put it is its place at time 0.
---@param x number x (a number): How far along x in a unit of time, as the parent measures.
---@param y number y (a number): How far along y.
---@param z number z (a number): How far along z.
---@return gr.node
---@overload fun(self: gr.node, vector: gr.triple): gr.node
function node:velocity(x, y, z) end

---Lets this node move from where its transforms put it at time 0 to where another's do at time 1, turning the short way.
---@param node gr.node node (a node): A node whose own transforms say where this one is at time 1; it need not be in the scene.
---@return gr.node
function node:moves_to(node) end

---Turns this node about any direction.
---@param axis gr.triple axis (a direction {x, y, z}): The axis: a direction of any length but 0.
---@param angle number angle (a number, in degrees): How far, counterclockwise seen from the axis' tip.
---@return gr.node
function node:rotate_axis(axis, angle) end

---Turns this node by a quaternion.
---@param w number w (a number): The cosine of half the angle, times any length but 0.
---@param x number x (a number): The axis times the sine of half the angle, times that length.
---@param y number y (a number): The same along y.
---@param z number z (a number): The same along z.
---@return gr.node
---@overload fun(self: gr.node, quaternion: number[]): gr.node
function node:rotate_quat(w, x, y, z) end

---Moves this node.
---@param x number x (a number): How far along x.
---@param y number y (a number): How far along y.
---@param z number z (a number): How far along z.
---@return gr.node
---@overload fun(self: gr.node, vector: gr.triple): gr.node
function node:translate(x, y, z) end

---The same as gr.render with this node.
---@param file string file (the name of a file): The picture to write: .png, or .pfm, .hdr or .exr for linear light; missing folders are made.
---@param width integer width (a whole number, 1 to 1048576, in pixels): Width of the picture.
---@param height integer height (a whole number, 1 to 1048576, in pixels): Height of the picture.
---@param eye gr.triple eye (a point {x, y, z}): Where the camera stands.
---@param view gr.triple view (a direction {x, y, z}; default {0, 0, -1}): The direction it looks in.
---@param up gr.triple up (a direction {x, y, z}; default {0, 1, 0}): The direction that is up in the picture.
---@param fov number fov (a number, > 0 and < 180, in degrees; default 50): The full vertical angle of view.
---@param ambient gr.triple ambient (a colour {r, g, b}; default {0, 0, 0}): Light that is everywhere.
---@param lights gr.light[] lights (a table of lights; default {}): A table of lights.
---@overload fun(self: gr.node, fields: gr.render.fields)
function node:render(file, width, height, eye, view, up, fov, ambient, lights) end

