---@meta

-- The gr functions for editors that understand LuaLS annotations. Written by `gray --annotations` from
-- the table in src/script/table.c; a test checks that it is current.

---@alias gr.triple number[] three numbers: a point, a direction, a colour
---@class gr.material
---@class gr.light
---@class gr.texture
---@field at fun(self: gr.texture, u: number, v: number): gr.vector, number
---@class gr.fog
---@class gr.medium
---@class gr.sky
---@class gr.vector: number[]
---@field x number
---@field y number
---@field z number
---@field dot fun(self: gr.vector, b: gr.triple): number
---@field cross fun(self: gr.vector, b: gr.triple): gr.vector
---@field length fun(self: gr.vector): number
---@field normalize fun(self: gr.vector): gr.vector
---@field mix fun(self: gr.vector, b: gr.triple, t: any): gr.vector
---@field clamp fun(self: gr.vector, low: any, high: any): gr.vector
---@operator add(any): gr.vector
---@operator sub(any): gr.vector
---@operator mul(any): gr.vector
---@operator div(any): gr.vector
---@operator unm: gr.vector
---@class gr.glyph
---@field code integer
---@field x number
---@field advance number
---@field missing boolean
---@field contours number[][][]
---@class gr.glyphs: gr.glyph[]
---@field width number
---@field ascender number
---@field descender number
---@field line number
---@class gr.node
local node = {}

gr = {}

---The version of the renderer.
gr.version = ''
---In an animation: the seconds since its first frame, else 0.
gr.time = 0.0
---Its argument t, from 0 to 1.
gr.clock = 0.0
---The number of the frame, from 1; 0 outside of animations.
gr.frame = 0

---@class gr.node.fields
---@field name? string name (a string; default 'node'): Name of the node, for messages.
---@field children? gr.node[] children (a table of nodes; default {}): Child nodes.

---A node with children and a transform.
---@param name? string name (a string; default 'node'): Name of the node, for messages.
---@return gr.node
---@overload fun(fields: gr.node.fields): gr.node
function gr.node(name) end

---@class gr.instances.fields
---@field name? string name (a string; default 'instances'): Name of the node, for messages.
---@field of gr.node of (a node): The node to place.
---@field at number[][] at (a table of tables of numbers): Its positions, {x, y, z}, or matrices of three rows, 12 numbers each.
---@field turn? number|number[] turn (a number or a table of numbers, in degrees; default 0): Angle of a rotation about axis, before the translation; one for each position, or one for all.
---@field axis? 'x'|'y'|'z' axis ('x', 'y' or 'z'; default 'y'): Axis of that rotation.
---@field size? number|number[] size (a number or a table of numbers, > 0; default 1): Scale factor, applied first; one for each position, or one for all.

---A node at many positions; each position costs a tenth of the memory of a node.
---@param of gr.node of (a node): The node to place.
---@param at number[][] at (a table of tables of numbers): Its positions, {x, y, z}, or matrices of three rows, 12 numbers each.
---@return gr.node
---@overload fun(fields: gr.instances.fields): gr.node
function gr.instances(of, at) end

---@class gr.joint.fields
---@field name? string name (a string; default 'joint'): Name of the node, for messages.
---@field x? gr.triple x (a table of 3 numbers, in degrees; default {0, 0, 0}): Smallest, initial and largest angle about x; gray draws the initial one.
---@field y? gr.triple y (a table of 3 numbers, in degrees; default {0, 0, 0}): The same for y.
---@field children? gr.node[] children (a table of nodes; default {}): Child nodes.

---A node that rotates about x and y, with limits of the angles.
---@param name string name (a string; default 'joint'): Name of the node, for messages.
---@param x? gr.triple x (a table of 3 numbers, in degrees; default {0, 0, 0}): Smallest, initial and largest angle about x; gray draws the initial one.
---@param y? gr.triple y (a table of 3 numbers, in degrees; default {0, 0, 0}): The same for y.
---@return gr.node
---@overload fun(fields: gr.joint.fields): gr.node
function gr.joint(name, x, y) end

---@class gr.sphere.fields
---@field name? string name (a string; default 'sphere'): Name of the node, for messages.
---@field material? gr.material material (a material; default plain gray): Material of the surface.
---@field thin_walled? boolean thin_walled (true or false; default whether it is open): Whether a transparent surface is a thin wall, which light passes straight on, for paths and photons.
---@field medium? gr.medium medium (a medium; default none): Fills the solid, instead of a material or behind its surface.
---@field centre? gr.triple centre (a point {x, y, z}; default {0, 0, 0}): Centre.
---@field radius? number radius (a number, > 0; default 1): Radius.

---A sphere; by default of radius 1 at the origin.
---@param material gr.material material (a material; default plain gray): Material of the surface.
---@return gr.node
---@overload fun(name: string): gr.node
---@overload fun(fields: gr.sphere.fields): gr.node
function gr.sphere(material) end

---@class gr.cube.fields
---@field name? string name (a string; default 'cube'): Name of the node, for messages.
---@field material? gr.material material (a material; default plain gray): Material of the surface.
---@field thin_walled? boolean thin_walled (true or false; default whether it is open): Whether a transparent surface is a thin wall, which light passes straight on, for paths and photons.
---@field medium? gr.medium medium (a medium; default none): Fills the solid, instead of a material or behind its surface.
---@field corner? gr.triple corner (a point {x, y, z}; default {0, 0, 0}): The corner with the smallest coordinates.
---@field size? number|gr.triple size (a number or a table of 3 numbers, not 0; default 1): Length of the edges, one number or three; a negative length extends in the negative direction.

---A cube; by default from (0,0,0) to (1,1,1).
---@param material gr.material material (a material; default plain gray): Material of the surface.
---@return gr.node
---@overload fun(name: string): gr.node
---@overload fun(fields: gr.cube.fields): gr.node
function gr.cube(material) end

---@class gr.nh_sphere.fields
---@field name? string name (a string; default 'sphere'): Name of the node, for messages.
---@field material? gr.material material (a material; default plain gray): Material of the surface.
---@field thin_walled? boolean thin_walled (true or false; default whether it is open): Whether a transparent surface is a thin wall, which light passes straight on, for paths and photons.
---@field medium? gr.medium medium (a medium; default none): Fills the solid, instead of a material or behind its surface.
---@field centre? gr.triple centre (a point {x, y, z}; default {0, 0, 0}): Centre.
---@field radius? number radius (a number, > 0; default 1): Radius.

---A sphere with centre and radius.
---@param name string name (a string; default 'sphere'): Name of the node, for messages.
---@param centre gr.triple centre (a point {x, y, z}; default {0, 0, 0}): Centre.
---@param radius number radius (a number, > 0; default 1): Radius.
---@return gr.node
---@overload fun(material: gr.material, centre: gr.triple, radius: number): gr.node
---@overload fun(fields: gr.nh_sphere.fields): gr.node
function gr.nh_sphere(name, centre, radius) end

---@class gr.nh_box.fields
---@field name? string name (a string; default 'cube'): Name of the node, for messages.
---@field material? gr.material material (a material; default plain gray): Material of the surface.
---@field thin_walled? boolean thin_walled (true or false; default whether it is open): Whether a transparent surface is a thin wall, which light passes straight on, for paths and photons.
---@field medium? gr.medium medium (a medium; default none): Fills the solid, instead of a material or behind its surface.
---@field corner? gr.triple corner (a point {x, y, z}; default {0, 0, 0}): The corner with the smallest coordinates.
---@field size? number|gr.triple size (a number or a table of 3 numbers, not 0; default 1): Length of the edges, one number or three; a negative length extends in the negative direction.

---A cube with corner and size.
---@param name string name (a string; default 'cube'): Name of the node, for messages.
---@param corner gr.triple corner (a point {x, y, z}; default {0, 0, 0}): The corner with the smallest coordinates.
---@param size number|gr.triple size (a number or a table of 3 numbers, not 0; default 1): Length of the edges, one number or three; a negative length extends in the negative direction.
---@return gr.node
---@overload fun(material: gr.material, corner: gr.triple, size: number|gr.triple): gr.node
---@overload fun(fields: gr.nh_box.fields): gr.node
function gr.nh_box(name, corner, size) end

---@class gr.mesh.fields
---@field name? string name (a string; default 'mesh'): Name of the node, for messages.
---@field material? gr.material material (a material; default plain gray): Material of the surface.
---@field file? string file (the name of a file; optional): An OBJ, PLY, STL, glTF or GLB file, instead of verts and faces.
---@field smooth? number smooth (a number, 0 to 180, in degrees; default the given normals): Crease angle: faces that meet at a smaller angle are shaded as one smooth surface; 0: all faces are flat.
---@field weld? boolean|number weld (true or false or a number, >= 0; default false): Whether vertices at the same position become one; a number: those closer than this.
---@field flip? boolean flip (true or false; default false): Whether the faces are reversed.
---@field cull? 'none'|'back'|'front' cull ('none'|'back'|'front'; default 'none'): Which faces rays ignore: those seen from behind, or those seen from the front.
---@field thin_walled? boolean thin_walled (true or false; default whether it is open): Whether a transparent surface is a thin wall, which light passes straight on, for paths and photons.
---@field medium? gr.medium medium (a medium; default none): Fills the solid, instead of a material or behind its surface.
---@field materials? table<string|integer, gr.material> materials (a table of materials; default the file's): Materials by the names of the parts in the file; with face_materials, a list.
---@field time? number time (a number, in seconds; default at rest): The moment of the file's animation (glTF).
---@field animation? string animation (a string; default the first one): The name of an animation in the file, or its number from 1.
---@field variant? string variant (a string; default the file's default): The name of a variant of the materials in the file (glTF).
---@field verts? gr.triple[] verts (a table of points {x, y, z}; optional): The vertices.
---@field normals? gr.triple[] normals (a table of points {x, y, z}; default none: flat): Vertex normals, of any length.
---@field faces? integer[][] faces (a table of tuples of indices; optional): Polygons: tuples of indices into verts, from 0.
---@field face_normals? integer[][] face_normals (a table of tuples of indices; default faces): For each face a tuple of indices into normals, from 0.
---@field uvs? number[][] uvs (a table of pairs {u, v}; default none): Texture coordinates, {u, v}; v = 0 is the lower edge of an image.
---@field face_uvs? integer[][] face_uvs (a table of tuples of indices; default faces): For each face a tuple of indices into uvs, from 0.
---@field face_materials? number|number[] face_materials (a number or a table of numbers; default material for all): With faces: the index into materials of each face, from 1.

---A mesh of polygons, flat or with vertex normals.
---@param material gr.material material (a material; default plain gray): Material of the surface.
---@param verts gr.triple[] verts (a table of points {x, y, z}; optional): The vertices.
---@param faces integer[][] faces (a table of tuples of indices; optional): Polygons: tuples of indices into verts, from 0.
---@return gr.node
---@overload fun(name: string, file: string): gr.node
---@overload fun(name: string, verts: gr.triple[], faces: integer[][]): gr.node
---@overload fun(material: gr.material, file: string): gr.node
---@overload fun(name: string, verts: gr.triple[], normals: gr.triple[], faces: integer[][]): gr.node
---@overload fun(fields: gr.mesh.fields): gr.node
function gr.mesh(material, verts, faces) end

---@class gr.model.fields
---@field name? string name (a string; default 'mesh'): Name of the node, for messages.
---@field material? gr.material material (a material; default plain gray): Material of the surface.
---@field file? string file (the name of a file; optional): An OBJ, PLY, STL, glTF or GLB file, instead of verts and faces.
---@field smooth? number smooth (a number, 0 to 180, in degrees; default the given normals): Crease angle: faces that meet at a smaller angle are shaded as one smooth surface; 0: all faces are flat.
---@field weld? boolean|number weld (true or false or a number, >= 0; default false): Whether vertices at the same position become one; a number: those closer than this.
---@field flip? boolean flip (true or false; default false): Whether the faces are reversed.
---@field cull? 'none'|'back'|'front' cull ('none'|'back'|'front'; default 'none'): Which faces rays ignore: those seen from behind, or those seen from the front.
---@field thin_walled? boolean thin_walled (true or false; default whether it is open): Whether a transparent surface is a thin wall, which light passes straight on, for paths and photons.
---@field medium? gr.medium medium (a medium; default none): Fills the solid, instead of a material or behind its surface.
---@field materials? table<string|integer, gr.material> materials (a table of materials; default the file's): Materials by the names of the parts in the file; with face_materials, a list.
---@field time? number time (a number, in seconds; default at rest): The moment of the file's animation (glTF).
---@field animation? string animation (a string; default the first one): The name of an animation in the file, or its number from 1.
---@field variant? string variant (a string; default the file's default): The name of a variant of the materials in the file (glTF).

---The same as gr.mesh of a file: its node, which also has its cameras and lights.
---@param file string file (the name of a file; optional): An OBJ, PLY, STL, glTF or GLB file, instead of verts and faces.
---@return gr.node
---@overload fun(fields: gr.model.fields): gr.node
function gr.model(file) end

---@class gr.fast_mesh.fields
---@field name? string name (a string; default 'mesh'): Name of the node, for messages.
---@field material? gr.material material (a material; default plain gray): Material of the surface.
---@field file? string file (the name of a file; optional): An OBJ, PLY, STL, glTF or GLB file, instead of verts and faces.
---@field smooth? number smooth (a number, 0 to 180, in degrees; default the given normals): Crease angle: faces that meet at a smaller angle are shaded as one smooth surface; 0: all faces are flat.
---@field weld? boolean|number weld (true or false or a number, >= 0; default false): Whether vertices at the same position become one; a number: those closer than this.
---@field flip? boolean flip (true or false; default false): Whether the faces are reversed.
---@field cull? 'none'|'back'|'front' cull ('none'|'back'|'front'; default 'none'): Which faces rays ignore: those seen from behind, or those seen from the front.
---@field thin_walled? boolean thin_walled (true or false; default whether it is open): Whether a transparent surface is a thin wall, which light passes straight on, for paths and photons.
---@field medium? gr.medium medium (a medium; default none): Fills the solid, instead of a material or behind its surface.
---@field materials? table<string|integer, gr.material> materials (a table of materials; default the file's): Materials by the names of the parts in the file; with face_materials, a list.
---@field time? number time (a number, in seconds; default at rest): The moment of the file's animation (glTF).
---@field animation? string animation (a string; default the first one): The name of an animation in the file, or its number from 1.
---@field variant? string variant (a string; default the file's default): The name of a variant of the materials in the file (glTF).
---@field verts? gr.triple[] verts (a table of points {x, y, z}; optional): The vertices.
---@field normals? gr.triple[] normals (a table of points {x, y, z}; default none: flat): Vertex normals, of any length.
---@field faces? integer[][] faces (a table of tuples of indices; optional): Polygons: tuples of indices into verts, from 0.
---@field face_normals? integer[][] face_normals (a table of tuples of indices; default faces): For each face a tuple of indices into normals, from 0.
---@field uvs? number[][] uvs (a table of pairs {u, v}; default none): Texture coordinates, {u, v}; v = 0 is the lower edge of an image.
---@field face_uvs? integer[][] face_uvs (a table of tuples of indices; default faces): For each face a tuple of indices into uvs, from 0.
---@field face_materials? number|number[] face_materials (a number or a table of numbers; default material for all): With faces: the index into materials of each face, from 1.

---The same as gr.mesh: every mesh is fast.
---@param material gr.material material (a material; default plain gray): Material of the surface.
---@param verts gr.triple[] verts (a table of points {x, y, z}; optional): The vertices.
---@param faces integer[][] faces (a table of tuples of indices; optional): Polygons: tuples of indices into verts, from 0.
---@return gr.node
---@overload fun(name: string, verts: gr.triple[], faces: integer[][]): gr.node
---@overload fun(fields: gr.fast_mesh.fields): gr.node
function gr.fast_mesh(material, verts, faces) end

---@class gr.vn_mesh.fields
---@field name? string name (a string; default 'mesh'): Name of the node, for messages.
---@field material? gr.material material (a material; default plain gray): Material of the surface.
---@field file? string file (the name of a file; optional): An OBJ, PLY, STL, glTF or GLB file, instead of verts and faces.
---@field smooth? number smooth (a number, 0 to 180, in degrees; default the given normals): Crease angle: faces that meet at a smaller angle are shaded as one smooth surface; 0: all faces are flat.
---@field weld? boolean|number weld (true or false or a number, >= 0; default false): Whether vertices at the same position become one; a number: those closer than this.
---@field flip? boolean flip (true or false; default false): Whether the faces are reversed.
---@field cull? 'none'|'back'|'front' cull ('none'|'back'|'front'; default 'none'): Which faces rays ignore: those seen from behind, or those seen from the front.
---@field thin_walled? boolean thin_walled (true or false; default whether it is open): Whether a transparent surface is a thin wall, which light passes straight on, for paths and photons.
---@field medium? gr.medium medium (a medium; default none): Fills the solid, instead of a material or behind its surface.
---@field materials? table<string|integer, gr.material> materials (a table of materials; default the file's): Materials by the names of the parts in the file; with face_materials, a list.
---@field time? number time (a number, in seconds; default at rest): The moment of the file's animation (glTF).
---@field animation? string animation (a string; default the first one): The name of an animation in the file, or its number from 1.
---@field variant? string variant (a string; default the file's default): The name of a variant of the materials in the file (glTF).
---@field verts? gr.triple[] verts (a table of points {x, y, z}; optional): The vertices.
---@field normals? gr.triple[] normals (a table of points {x, y, z}; default none: flat): Vertex normals, of any length.
---@field faces? integer[][] faces (a table of tuples of indices; optional): Polygons: tuples of indices into verts, from 0.
---@field face_normals? integer[][] face_normals (a table of tuples of indices; default faces): For each face a tuple of indices into normals, from 0.
---@field uvs? number[][] uvs (a table of pairs {u, v}; default none): Texture coordinates, {u, v}; v = 0 is the lower edge of an image.
---@field face_uvs? integer[][] face_uvs (a table of tuples of indices; default faces): For each face a tuple of indices into uvs, from 0.
---@field face_materials? number|number[] face_materials (a number or a table of numbers; default material for all): With faces: the index into materials of each face, from 1.

---A mesh with vertex normals.
---@param material gr.material material (a material; default plain gray): Material of the surface.
---@param verts gr.triple[] verts (a table of points {x, y, z}; optional): The vertices.
---@param normals gr.triple[] normals (a table of points {x, y, z}; default none: flat): Vertex normals, of any length.
---@param faces integer[][] faces (a table of tuples of indices; optional): Polygons: tuples of indices into verts, from 0.
---@param face_normals integer[][] face_normals (a table of tuples of indices; default faces): For each face a tuple of indices into normals, from 0.
---@return gr.node
---@overload fun(name: string, verts: gr.triple[], normals: gr.triple[], faces: integer[][], face_normals: integer[][]): gr.node
---@overload fun(fields: gr.vn_mesh.fields): gr.node
function gr.vn_mesh(material, verts, normals, faces, face_normals) end

---@class gr.fast_vn_mesh.fields
---@field name? string name (a string; default 'mesh'): Name of the node, for messages.
---@field material? gr.material material (a material; default plain gray): Material of the surface.
---@field file? string file (the name of a file; optional): An OBJ, PLY, STL, glTF or GLB file, instead of verts and faces.
---@field smooth? number smooth (a number, 0 to 180, in degrees; default the given normals): Crease angle: faces that meet at a smaller angle are shaded as one smooth surface; 0: all faces are flat.
---@field weld? boolean|number weld (true or false or a number, >= 0; default false): Whether vertices at the same position become one; a number: those closer than this.
---@field flip? boolean flip (true or false; default false): Whether the faces are reversed.
---@field cull? 'none'|'back'|'front' cull ('none'|'back'|'front'; default 'none'): Which faces rays ignore: those seen from behind, or those seen from the front.
---@field thin_walled? boolean thin_walled (true or false; default whether it is open): Whether a transparent surface is a thin wall, which light passes straight on, for paths and photons.
---@field medium? gr.medium medium (a medium; default none): Fills the solid, instead of a material or behind its surface.
---@field materials? table<string|integer, gr.material> materials (a table of materials; default the file's): Materials by the names of the parts in the file; with face_materials, a list.
---@field time? number time (a number, in seconds; default at rest): The moment of the file's animation (glTF).
---@field animation? string animation (a string; default the first one): The name of an animation in the file, or its number from 1.
---@field variant? string variant (a string; default the file's default): The name of a variant of the materials in the file (glTF).
---@field verts? gr.triple[] verts (a table of points {x, y, z}; optional): The vertices.
---@field normals? gr.triple[] normals (a table of points {x, y, z}; default none: flat): Vertex normals, of any length.
---@field faces? integer[][] faces (a table of tuples of indices; optional): Polygons: tuples of indices into verts, from 0.
---@field face_normals? integer[][] face_normals (a table of tuples of indices; default faces): For each face a tuple of indices into normals, from 0.
---@field uvs? number[][] uvs (a table of pairs {u, v}; default none): Texture coordinates, {u, v}; v = 0 is the lower edge of an image.
---@field face_uvs? integer[][] face_uvs (a table of tuples of indices; default faces): For each face a tuple of indices into uvs, from 0.
---@field face_materials? number|number[] face_materials (a number or a table of numbers; default material for all): With faces: the index into materials of each face, from 1.

---The same as gr.vn_mesh.
---@param material gr.material material (a material; default plain gray): Material of the surface.
---@param verts gr.triple[] verts (a table of points {x, y, z}; optional): The vertices.
---@param normals gr.triple[] normals (a table of points {x, y, z}; default none: flat): Vertex normals, of any length.
---@param faces integer[][] faces (a table of tuples of indices; optional): Polygons: tuples of indices into verts, from 0.
---@param face_normals integer[][] face_normals (a table of tuples of indices; default faces): For each face a tuple of indices into normals, from 0.
---@return gr.node
---@overload fun(name: string, verts: gr.triple[], normals: gr.triple[], faces: integer[][], face_normals: integer[][]): gr.node
---@overload fun(fields: gr.fast_vn_mesh.fields): gr.node
function gr.fast_vn_mesh(material, verts, normals, faces, face_normals) end

---@class gr.geometry.fields
---@field name? string name (a string; default 'geometry'): Name of the node, for messages.
---@field primitive gr.node primitive (a node): A primitive, for instance gr.sphere(mat).
---@field material? gr.material material (a material; default the primitive's): Material of the surface.

---A node with the shape and material of a primitive.
---@param name string name (a string; default 'geometry'): Name of the node, for messages.
---@param primitive gr.node primitive (a node): A primitive, for instance gr.sphere(mat).
---@return gr.node
---@overload fun(fields: gr.geometry.fields): gr.node
function gr.geometry(name, primitive) end

---@class gr.csg_union.fields
---@field name? string name (a string; default 'csg'): Name of the node, for messages.
---@field a gr.node a (a node): A closed solid; a group is the union of the solids below it.
---@field b gr.node b (a node): The second operand.
---@field operands? gr.node[] operands (a table of nodes; optional): Further operands: as extra arguments, as this list, or as unnamed entries of the table; a and b may be left out then.

---The union of solids: points in any operand. It has no inner walls.
---@param name string name (a string; default 'csg'): Name of the node, for messages.
---@param a gr.node a (a node): A closed solid; a group is the union of the solids below it.
---@param b gr.node b (a node): The second operand.
---@param ... gr.node
---@return gr.node
---@overload fun(a: gr.node, b: gr.node, ...: gr.node): gr.node
---@overload fun(fields: gr.csg_union.fields): gr.node
function gr.csg_union(name, a, b, ...) end

---@class gr.csg_difference.fields
---@field name? string name (a string; default 'csg'): Name of the node, for messages.
---@field a gr.node a (a node): A closed solid; a group is the union of the solids below it.
---@field b gr.node b (a node): The second operand.
---@field operands? gr.node[] operands (a table of nodes; optional): Further operands: as extra arguments, as this list, or as unnamed entries of the table; a and b may be left out then.

---The difference of solids: points in the first operand and in none of the others.
---@param name string name (a string; default 'csg'): Name of the node, for messages.
---@param a gr.node a (a node): A closed solid; a group is the union of the solids below it.
---@param b gr.node b (a node): The second operand.
---@param ... gr.node
---@return gr.node
---@overload fun(a: gr.node, b: gr.node, ...: gr.node): gr.node
---@overload fun(fields: gr.csg_difference.fields): gr.node
function gr.csg_difference(name, a, b, ...) end

---@class gr.csg_intersection.fields
---@field name? string name (a string; default 'csg'): Name of the node, for messages.
---@field a gr.node a (a node): A closed solid; a group is the union of the solids below it.
---@field b gr.node b (a node): The second operand.
---@field operands? gr.node[] operands (a table of nodes; optional): Further operands: as extra arguments, as this list, or as unnamed entries of the table; a and b may be left out then.

---The intersection of solids: points in all operands.
---@param name string name (a string; default 'csg'): Name of the node, for messages.
---@param a gr.node a (a node): A closed solid; a group is the union of the solids below it.
---@param b gr.node b (a node): The second operand.
---@param ... gr.node
---@return gr.node
---@overload fun(a: gr.node, b: gr.node, ...: gr.node): gr.node
---@overload fun(fields: gr.csg_intersection.fields): gr.node
function gr.csg_intersection(name, a, b, ...) end

---@class gr.csg_merge.fields
---@field name? string name (a string; default 'csg'): Name of the node, for messages.
---@field a gr.node a (a node): A closed solid; a group is the union of the solids below it.
---@field b gr.node b (a node): The second operand.
---@field operands? gr.node[] operands (a table of nodes; optional): Further operands: as extra arguments, as this list, or as unnamed entries of the table; a and b may be left out then.

---The same as gr.csg_union, which has no inner walls either; a plain node keeps them.
---@param name string name (a string; default 'csg'): Name of the node, for messages.
---@param a gr.node a (a node): A closed solid; a group is the union of the solids below it.
---@param b gr.node b (a node): The second operand.
---@param ... gr.node
---@return gr.node
---@overload fun(a: gr.node, b: gr.node, ...: gr.node): gr.node
---@overload fun(fields: gr.csg_merge.fields): gr.node
function gr.csg_merge(name, a, b, ...) end

---@class gr.csg_inverse.fields
---@field name? string name (a string; default 'inverse'): Name of the node, for messages.
---@field a gr.node a (a node): A closed solid; a group is the union of the solids below it.

---The complement of a solid: the same surface, turned inside out.
---@param name string name (a string; default 'inverse'): Name of the node, for messages.
---@param a gr.node a (a node): A closed solid; a group is the union of the solids below it.
---@return gr.node
---@overload fun(a: gr.node): gr.node
---@overload fun(fields: gr.csg_inverse.fields): gr.node
function gr.csg_inverse(name, a) end

---@class gr.union.fields
---@field name? string name (a string; default 'csg'): Name of the node, for messages.
---@field a gr.node a (a node): A closed solid; a group is the union of the solids below it.
---@field b gr.node b (a node): The second operand.
---@field operands? gr.node[] operands (a table of nodes; optional): Further operands: as extra arguments, as this list, or as unnamed entries of the table; a and b may be left out then.

---The same as gr.csg_union.
---@param name string name (a string; default 'csg'): Name of the node, for messages.
---@param a gr.node a (a node): A closed solid; a group is the union of the solids below it.
---@param b gr.node b (a node): The second operand.
---@param ... gr.node
---@return gr.node
---@overload fun(a: gr.node, b: gr.node, ...: gr.node): gr.node
---@overload fun(fields: gr.union.fields): gr.node
function gr.union(name, a, b, ...) end

---@class gr.difference.fields
---@field name? string name (a string; default 'csg'): Name of the node, for messages.
---@field a gr.node a (a node): A closed solid; a group is the union of the solids below it.
---@field b gr.node b (a node): The second operand.
---@field operands? gr.node[] operands (a table of nodes; optional): Further operands: as extra arguments, as this list, or as unnamed entries of the table; a and b may be left out then.

---The same as gr.csg_difference.
---@param name string name (a string; default 'csg'): Name of the node, for messages.
---@param a gr.node a (a node): A closed solid; a group is the union of the solids below it.
---@param b gr.node b (a node): The second operand.
---@param ... gr.node
---@return gr.node
---@overload fun(a: gr.node, b: gr.node, ...: gr.node): gr.node
---@overload fun(fields: gr.difference.fields): gr.node
function gr.difference(name, a, b, ...) end

---@class gr.intersection.fields
---@field name? string name (a string; default 'csg'): Name of the node, for messages.
---@field a gr.node a (a node): A closed solid; a group is the union of the solids below it.
---@field b gr.node b (a node): The second operand.
---@field operands? gr.node[] operands (a table of nodes; optional): Further operands: as extra arguments, as this list, or as unnamed entries of the table; a and b may be left out then.

---The same as gr.csg_intersection.
---@param name string name (a string; default 'csg'): Name of the node, for messages.
---@param a gr.node a (a node): A closed solid; a group is the union of the solids below it.
---@param b gr.node b (a node): The second operand.
---@param ... gr.node
---@return gr.node
---@overload fun(a: gr.node, b: gr.node, ...: gr.node): gr.node
---@overload fun(fields: gr.intersection.fields): gr.node
function gr.intersection(name, a, b, ...) end

---@class gr.merge.fields
---@field name? string name (a string; default 'csg'): Name of the node, for messages.
---@field a gr.node a (a node): A closed solid; a group is the union of the solids below it.
---@field b gr.node b (a node): The second operand.
---@field operands? gr.node[] operands (a table of nodes; optional): Further operands: as extra arguments, as this list, or as unnamed entries of the table; a and b may be left out then.

---The same as gr.csg_merge.
---@param name string name (a string; default 'csg'): Name of the node, for messages.
---@param a gr.node a (a node): A closed solid; a group is the union of the solids below it.
---@param b gr.node b (a node): The second operand.
---@param ... gr.node
---@return gr.node
---@overload fun(a: gr.node, b: gr.node, ...: gr.node): gr.node
---@overload fun(fields: gr.merge.fields): gr.node
function gr.merge(name, a, b, ...) end

---@class gr.inverse.fields
---@field name? string name (a string; default 'inverse'): Name of the node, for messages.
---@field a gr.node a (a node): A closed solid; a group is the union of the solids below it.

---The same as gr.csg_inverse.
---@param name string name (a string; default 'inverse'): Name of the node, for messages.
---@param a gr.node a (a node): A closed solid; a group is the union of the solids below it.
---@return gr.node
---@overload fun(a: gr.node): gr.node
---@overload fun(fields: gr.inverse.fields): gr.node
function gr.inverse(name, a) end

---@class gr.clipped_by.fields
---@field name? string name (a string; default 'clipped'): Name of the node, for messages.
---@field object gr.node object (a node): The visible object: a shape or a group of shapes.
---@field by gr.node by (a node): A closed solid; the part of the object inside it remains.

---The part of the surfaces of an object that is inside a solid: cut open, without caps. It is not a CSG operand.
---@param name string name (a string; default 'clipped'): Name of the node, for messages.
---@param object gr.node object (a node): The visible object: a shape or a group of shapes.
---@param by gr.node by (a node): A closed solid; the part of the object inside it remains.
---@return gr.node
---@overload fun(object: gr.node, by: gr.node): gr.node
---@overload fun(fields: gr.clipped_by.fields): gr.node
function gr.clipped_by(name, object, by) end

---@class gr.bounded_by.fields
---@field name? string name (a string; default 'bounded'): Name of the node, for messages.
---@field object gr.node object (a node): The visible object: a shape or a group of shapes.
---@field by gr.node by (a node): A closed solid that contains the object. gray does not verify this: parts outside may or may not be visible.

---The object, with the hint that a solid contains it. This makes objects with a large bounding box faster.
---@param name string name (a string; default 'bounded'): Name of the node, for messages.
---@param object gr.node object (a node): The visible object: a shape or a group of shapes.
---@param by gr.node by (a node): A closed solid that contains the object. gray does not verify this: parts outside may or may not be visible.
---@return gr.node
---@overload fun(object: gr.node, by: gr.node): gr.node
---@overload fun(fields: gr.bounded_by.fields): gr.node
function gr.bounded_by(name, object, by) end

---@class gr.cylinder.fields
---@field name? string name (a string; default 'cylinder'): Name of the node, for messages.
---@field material? gr.material material (a material; default plain gray): Material of the surface.
---@field thin_walled? boolean thin_walled (true or false; default whether it is open): Whether a transparent surface is a thin wall, which light passes straight on, for paths and photons.
---@field medium? gr.medium medium (a medium; default none): Fills the solid, instead of a material or behind its surface.
---@field from? gr.triple from (a point {x, y, z}; default {0, -1, 0}): Centre of one end.
---@field to? gr.triple to (a point {x, y, z}; default {0, 1, 0}): Centre of the other end.
---@field radius? number radius (a number, > 0; default 1): Radius.
---@field open? boolean open (true or false; default false): Whether it has no caps; without caps it is not a solid for CSG.
---@field edge? number edge (a number, >= 0; default 0): Radius of its rounded edges; 0: they are sharp.
---@field chamfer? boolean chamfer (true or false; default false): Whether edges are cut at 45 degrees instead, so far from them.

---A capped cylinder; by default about the y axis, of radius 1, from y = -1 to 1.
---@param material gr.material material (a material; default plain gray): Material of the surface.
---@return gr.node
---@overload fun(name: string): gr.node
---@overload fun(fields: gr.cylinder.fields): gr.node
function gr.cylinder(material) end

---@class gr.cone.fields
---@field name? string name (a string; default 'cone'): Name of the node, for messages.
---@field material? gr.material material (a material; default plain gray): Material of the surface.
---@field thin_walled? boolean thin_walled (true or false; default whether it is open): Whether a transparent surface is a thin wall, which light passes straight on, for paths and photons.
---@field medium? gr.medium medium (a medium; default none): Fills the solid, instead of a material or behind its surface.
---@field from? gr.triple from (a point {x, y, z}; default {0, 0, 0}): The apex, or the centre of the end with from_radius.
---@field to? gr.triple to (a point {x, y, z}; default {0, 1, 0}): Centre of the end with radius.
---@field from_radius? number from_radius (a number, >= 0; default 0): Radius at from; above 0 it is a frustum.
---@field radius? number radius (a number, >= 0; default 1): Radius at to.
---@field open? boolean open (true or false; default false): Whether it has no caps; without caps it is not a solid for CSG.

---A capped cone or frustum; by default with apex at the origin and radius 1 at y = 1.
---@param material gr.material material (a material; default plain gray): Material of the surface.
---@return gr.node
---@overload fun(name: string): gr.node
---@overload fun(fields: gr.cone.fields): gr.node
function gr.cone(material) end

---@class gr.torus.fields
---@field name? string name (a string; default 'torus'): Name of the node, for messages.
---@field material? gr.material material (a material; default plain gray): Material of the surface.
---@field thin_walled? boolean thin_walled (true or false; default whether it is open): Whether a transparent surface is a thin wall, which light passes straight on, for paths and photons.
---@field medium? gr.medium medium (a medium; default none): Fills the solid, instead of a material or behind its surface.
---@field major? number major (a number, >= 0; default 1): Radius of the centre circle in the plane y = 0.
---@field minor? number minor (a number, > 0; default 0.25): Radius of the tube.

---A torus about the y axis.
---@param name string name (a string; default 'torus'): Name of the node, for messages.
---@param major? number major (a number, >= 0; default 1): Radius of the centre circle in the plane y = 0.
---@param minor? number minor (a number, > 0; default 0.25): Radius of the tube.
---@return gr.node
---@overload fun(material: gr.material, major?: number, minor?: number): gr.node
---@overload fun(fields: gr.torus.fields): gr.node
function gr.torus(name, major, minor) end

---@class gr.plane.fields
---@field name? string name (a string; default 'plane'): Name of the node, for messages.
---@field material? gr.material material (a material; default plain gray): Material of the surface.
---@field thin_walled? boolean thin_walled (true or false; default whether it is open): Whether a transparent surface is a thin wall, which light passes straight on, for paths and photons.
---@field medium? gr.medium medium (a medium; default none): Fills the solid, instead of a material or behind its surface.
---@field normal? gr.triple normal (a direction {x, y, z}; default none: the square): Normal of an infinite plane; in CSG the plane is a half-space.
---@field distance? number distance (a number; default 0): Distance of the plane from the origin along the normal.

---The square from -0.5 to 0.5 in x and z at y = 0; with a normal, an infinite plane.
---@param material gr.material material (a material; default plain gray): Material of the surface.
---@return gr.node
---@overload fun(name: string): gr.node
---@overload fun(fields: gr.plane.fields): gr.node
function gr.plane(material) end

---@class gr.square.fields
---@field name? string name (a string; default 'square'): Name of the node, for messages.
---@field material? gr.material material (a material; default plain gray): Material of the surface.
---@field thin_walled? boolean thin_walled (true or false; default whether it is open): Whether a transparent surface is a thin wall, which light passes straight on, for paths and photons.
---@field medium? gr.medium medium (a medium; default none): Fills the solid, instead of a material or behind its surface.

---The square from -0.5 to 0.5 in x and z at y = 0.
---@param material gr.material material (a material; default plain gray): Material of the surface.
---@return gr.node
---@overload fun(name: string): gr.node
---@overload fun(fields: gr.square.fields): gr.node
function gr.square(material) end

---@class gr.box.fields
---@field name? string name (a string; default 'box'): Name of the node, for messages.
---@field material? gr.material material (a material; default plain gray): Material of the surface.
---@field thin_walled? boolean thin_walled (true or false; default whether it is open): Whether a transparent surface is a thin wall, which light passes straight on, for paths and photons.
---@field medium? gr.medium medium (a medium; default none): Fills the solid, instead of a material or behind its surface.
---@field min gr.triple min (a point {x, y, z}): A corner.
---@field max gr.triple max (a point {x, y, z}): The opposite corner.
---@field edge? number edge (a number, >= 0; default 0): Radius of its rounded edges; 0: they are sharp.
---@field chamfer? boolean chamfer (true or false; default false): Whether edges are cut at 45 degrees instead, so far from them.

---A box between two corners.
---@param material gr.material material (a material; default plain gray): Material of the surface.
---@param min gr.triple min (a point {x, y, z}): A corner.
---@param max gr.triple max (a point {x, y, z}): The opposite corner.
---@return gr.node
---@overload fun(name: string, min: gr.triple, max: gr.triple): gr.node
---@overload fun(fields: gr.box.fields): gr.node
function gr.box(material, min, max) end

---@class gr.ellipsoid.fields
---@field name? string name (a string; default 'ellipsoid'): Name of the node, for messages.
---@field material? gr.material material (a material; default plain gray): Material of the surface.
---@field thin_walled? boolean thin_walled (true or false; default whether it is open): Whether a transparent surface is a thin wall, which light passes straight on, for paths and photons.
---@field medium? gr.medium medium (a medium; default none): Fills the solid, instead of a material or behind its surface.
---@field centre? gr.triple centre (a point {x, y, z}; default {0, 0, 0}): Centre.
---@field radii? number|gr.triple radii (a number or a table of 3 numbers; default 1): Radii along x, y and z: one number or three.

---An ellipsoid along the axes.
---@param material gr.material material (a material; default plain gray): Material of the surface.
---@param radii? number|gr.triple radii (a number or a table of 3 numbers; default 1): Radii along x, y and z: one number or three.
---@return gr.node
---@overload fun(name: string, radii?: number|gr.triple): gr.node
---@overload fun(fields: gr.ellipsoid.fields): gr.node
function gr.ellipsoid(material, radii) end

---@class gr.paraboloid.fields
---@field name? string name (a string; default 'paraboloid'): Name of the node, for messages.
---@field material? gr.material material (a material; default plain gray): Material of the surface.
---@field thin_walled? boolean thin_walled (true or false; default whether it is open): Whether a transparent surface is a thin wall, which light passes straight on, for paths and photons.
---@field medium? gr.medium medium (a medium; default none): Fills the solid, instead of a material or behind its surface.
---@field radius? number radius (a number, > 0; default 1): Radius of the rim.
---@field height? number height (a number, > 0; default 1): y of the rim; the apex is at the origin.
---@field open? boolean open (true or false; default false): Whether it has no caps; without caps it is not a solid for CSG.

---A capped paraboloid that opens along y.
---@param material gr.material material (a material; default plain gray): Material of the surface.
---@return gr.node
---@overload fun(name: string): gr.node
---@overload fun(fields: gr.paraboloid.fields): gr.node
function gr.paraboloid(material) end

---@class gr.hyperboloid.fields
---@field name? string name (a string; default 'hyperboloid'): Name of the node, for messages.
---@field material? gr.material material (a material; default plain gray): Material of the surface.
---@field thin_walled? boolean thin_walled (true or false; default whether it is open): Whether a transparent surface is a thin wall, which light passes straight on, for paths and photons.
---@field medium? gr.medium medium (a medium; default none): Fills the solid, instead of a material or behind its surface.
---@field sheets? integer sheets (a whole number, 1 to 2; default 1, with gap 2): 1: one sheet with a waist; 2: two bowls.
---@field radius? number radius (a number, > 0; default twice waist, or 1): Radius of both rims.
---@field height? number height (a number, > 0; default twice gap, or 1): y of one rim; the other is at -y.
---@field waist? number waist (a number, > 0; default radius/2): Radius at y = 0, for one sheet.
---@field gap? number gap (a number, > 0; default height/2): y of one apex, for two sheets; the other is at -y.
---@field open? boolean open (true or false; default false): Whether it has no caps; without caps it is not a solid for CSG.

---A capped hyperboloid about y, of one sheet or of two.
---@param material gr.material material (a material; default plain gray): Material of the surface.
---@return gr.node
---@overload fun(name: string): gr.node
---@overload fun(fields: gr.hyperboloid.fields): gr.node
function gr.hyperboloid(material) end

---@class gr.quadric.fields
---@field name? string name (a string; default 'quadric'): Name of the node, for messages.
---@field material? gr.material material (a material; default plain gray): Material of the surface.
---@field thin_walled? boolean thin_walled (true or false; default whether it is open): Whether a transparent surface is a thin wall, which light passes straight on, for paths and photons.
---@field medium? gr.medium medium (a medium; default none): Fills the solid, instead of a material or behind its surface.
---@field xx? number xx (a number; default 0): Coefficient.
---@field yy? number yy (a number; default 0): Coefficient.
---@field zz? number zz (a number; default 0): Coefficient.
---@field xy? number xy (a number; default 0): Coefficient.
---@field xz? number xz (a number; default 0): Coefficient.
---@field yz? number yz (a number; default 0): Coefficient.
---@field x? number x (a number; default 0): Coefficient.
---@field y? number y (a number; default 0): Coefficient.
---@field z? number z (a number; default 0): Coefficient.
---@field constant? number constant (a number; default 0): Constant term; the solid is where the sum is negative.
---@field min? gr.triple min (a point {x, y, z}; default infinite): Corner of a box that limits it.
---@field max? gr.triple max (a point {x, y, z}; default infinite): The opposite corner.
---@field open? boolean open (true or false; default false): Whether it has no caps; without caps it is not a solid for CSG.

---The solid where xx x^2 + yy y^2 + zz z^2 + xy x y + xz x z + yz y z + x x + y y + z z + constant < 0.
---@param material gr.material material (a material; default plain gray): Material of the surface.
---@param xx number xx (a number; default 0): Coefficient.
---@param yy number yy (a number; default 0): Coefficient.
---@param zz number zz (a number; default 0): Coefficient.
---@param constant number constant (a number; default 0): Constant term; the solid is where the sum is negative.
---@return gr.node
---@overload fun(name: string, xx: number, yy: number, zz: number, constant: number): gr.node
---@overload fun(fields: gr.quadric.fields): gr.node
function gr.quadric(material, xx, yy, zz, constant) end

---@class gr.superellipsoid.fields
---@field name? string name (a string; default 'superellipsoid'): Name of the node, for messages.
---@field material? gr.material material (a material; default plain gray): Material of the surface.
---@field thin_walled? boolean thin_walled (true or false; default whether it is open): Whether a transparent surface is a thin wall, which light passes straight on, for paths and photons.
---@field medium? gr.medium medium (a medium; default none): Fills the solid, instead of a material or behind its surface.
---@field e? number e (a number, 0.02 to 20; default 1): Exponent of the cross-section: near 0 a square, 1 a circle, 2 a diamond.
---@field n? number n (a number, 0.02 to 20; default 1): Exponent of the profile, likewise.

---A rounded cube, cylinder, double cone or star: (|x|^(2/e) + |z|^(2/e))^(e/n) + |y|^(2/n) = 1.
---@param material gr.material material (a material; default plain gray): Material of the surface.
---@param e? number e (a number, 0.02 to 20; default 1): Exponent of the cross-section: near 0 a square, 1 a circle, 2 a diamond.
---@param n? number n (a number, 0.02 to 20; default 1): Exponent of the profile, likewise.
---@return gr.node
---@overload fun(name: string, e?: number, n?: number): gr.node
---@overload fun(fields: gr.superellipsoid.fields): gr.node
function gr.superellipsoid(material, e, n) end

---@class gr.rectangle.fields
---@field name? string name (a string; default 'rectangle'): Name of the node, for messages.
---@field material? gr.material material (a material; default plain gray): Material of the surface.
---@field thin_walled? boolean thin_walled (true or false; default whether it is open): Whether a transparent surface is a thin wall, which light passes straight on, for paths and photons.
---@field medium? gr.medium medium (a medium; default none): Fills the solid, instead of a material or behind its surface.
---@field corner? gr.triple corner (a point {x, y, z}; default {-0.5, 0, 0.5}): Corner where an image has its lower left.
---@field along? gr.triple along (a direction {x, y, z}; default {1, 0, 0}): Edge along u of an image.
---@field up? gr.triple up (a direction {x, y, z}; default {0, 0, -1}): Edge along v of an image; not parallel to along.

---A rectangle or parallelogram.
---@param material gr.material material (a material; default plain gray): Material of the surface.
---@param corner? gr.triple corner (a point {x, y, z}; default {-0.5, 0, 0.5}): Corner where an image has its lower left.
---@param along? gr.triple along (a direction {x, y, z}; default {1, 0, 0}): Edge along u of an image.
---@param up? gr.triple up (a direction {x, y, z}; default {0, 0, -1}): Edge along v of an image; not parallel to along.
---@return gr.node
---@overload fun(name: string, corner?: gr.triple, along?: gr.triple, up?: gr.triple): gr.node
---@overload fun(fields: gr.rectangle.fields): gr.node
function gr.rectangle(material, corner, along, up) end

---@class gr.disc.fields
---@field name? string name (a string; default 'disc'): Name of the node, for messages.
---@field material? gr.material material (a material; default plain gray): Material of the surface.
---@field thin_walled? boolean thin_walled (true or false; default whether it is open): Whether a transparent surface is a thin wall, which light passes straight on, for paths and photons.
---@field medium? gr.medium medium (a medium; default none): Fills the solid, instead of a material or behind its surface.
---@field centre? gr.triple centre (a point {x, y, z}; default {0, 0, 0}): Centre.
---@field normal? gr.triple normal (a direction {x, y, z}; default {0, 1, 0}): Normal of the front.
---@field radius? number radius (a number, > 0; default 1, or twice inner): Radius.
---@field inner? number inner (a number, >= 0; default 0): Radius of the hole.

---A disc, or a ring.
---@param material gr.material material (a material; default plain gray): Material of the surface.
---@return gr.node
---@overload fun(name: string): gr.node
---@overload fun(fields: gr.disc.fields): gr.node
function gr.disc(material) end

---@class gr.triangle.fields
---@field name? string name (a string; default 'triangle'): Name of the node, for messages.
---@field material? gr.material material (a material; default plain gray): Material of the surface.
---@field thin_walled? boolean thin_walled (true or false; default whether it is open): Whether a transparent surface is a thin wall, which light passes straight on, for paths and photons.
---@field medium? gr.medium medium (a medium; default none): Fills the solid, instead of a material or behind its surface.
---@field a gr.triple a (a point {x, y, z}): A corner; from the front, a, b, c run counterclockwise.
---@field b gr.triple b (a point {x, y, z}): The next corner.
---@field c gr.triple c (a point {x, y, z}): The last corner.

---A triangle.
---@param material gr.material material (a material; default plain gray): Material of the surface.
---@param a gr.triple a (a point {x, y, z}): A corner; from the front, a, b, c run counterclockwise.
---@param b gr.triple b (a point {x, y, z}): The next corner.
---@param c gr.triple c (a point {x, y, z}): The last corner.
---@return gr.node
---@overload fun(name: string, a: gr.triple, b: gr.triple, c: gr.triple): gr.node
---@overload fun(fields: gr.triangle.fields): gr.node
function gr.triangle(material, a, b, c) end

---@class gr.polygon.fields
---@field name? string name (a string; default 'polygon'): Name of the node, for messages.
---@field material? gr.material material (a material; default plain gray): Material of the surface.
---@field thin_walled? boolean thin_walled (true or false; default whether it is open): Whether a transparent surface is a thin wall, which light passes straight on, for paths and photons.
---@field medium? gr.medium medium (a medium; default none): Fills the solid, instead of a material or behind its surface.
---@field points gr.triple[] points (a table of points {x, y, z}): Corners in one plane; from the front, the first outline runs counterclockwise.
---@field outlines? integer[][] outlines (a table of tuples of indices; default all points in order): Tuples of indices into points, from 0; the polygon is filled by the even-odd rule.

---A polygon of any shape, with holes.
---@param material gr.material material (a material; default plain gray): Material of the surface.
---@param points gr.triple[] points (a table of points {x, y, z}): Corners in one plane; from the front, the first outline runs counterclockwise.
---@param outlines? integer[][] outlines (a table of tuples of indices; default all points in order): Tuples of indices into points, from 0; the polygon is filled by the even-odd rule.
---@return gr.node
---@overload fun(name: string, points: gr.triple[], outlines?: integer[][]): gr.node
---@overload fun(fields: gr.polygon.fields): gr.node
function gr.polygon(material, points, outlines) end

---@class gr.lathe.fields
---@field name? string name (a string; default 'lathe'): Name of the node, for messages.
---@field material? gr.material material (a material; default plain gray): Material of the surface.
---@field thin_walled? boolean thin_walled (true or false; default whether it is open): Whether a transparent surface is a thin wall, which light passes straight on, for paths and photons.
---@field medium? gr.medium medium (a medium; default none): Fills the solid, instead of a material or behind its surface.
---@field points number[][] points (a table of pairs {u, v}): The profile: pairs of radius and y.
---@field spline? 'linear'|'catmull-rom'|'b-spline'|'bezier' spline ('linear'|'catmull-rom'|'b-spline'|'bezier'; default 'linear'): Kind of spline through the points; bezier needs 3 n + 1 points.
---@field loop? boolean loop (true or false; default false): Whether the profile is closed.
---@field open? boolean open (true or false; default false): Whether ends off the axis have no discs.

---A surface of revolution: a profile rotated about the y axis.
---@param material gr.material material (a material; default plain gray): Material of the surface.
---@param points number[][] points (a table of pairs {u, v}): The profile: pairs of radius and y.
---@param spline? 'linear'|'catmull-rom'|'b-spline'|'bezier' spline ('linear'|'catmull-rom'|'b-spline'|'bezier'; default 'linear'): Kind of spline through the points; bezier needs 3 n + 1 points.
---@return gr.node
---@overload fun(name: string, points: number[][], spline?: 'linear'|'catmull-rom'|'b-spline'|'bezier'): gr.node
---@overload fun(fields: gr.lathe.fields): gr.node
function gr.lathe(material, points, spline) end

---@class gr.prism.fields
---@field name? string name (a string; default 'prism'): Name of the node, for messages.
---@field material? gr.material material (a material; default plain gray): Material of the surface.
---@field thin_walled? boolean thin_walled (true or false; default whether it is open): Whether a transparent surface is a thin wall, which light passes straight on, for paths and photons.
---@field medium? gr.medium medium (a medium; default none): Fills the solid, instead of a material or behind its surface.
---@field outline number[][] outline (a table of pairs {u, v}): A closed curve: pairs of x and z.
---@field holes? number[][][] holes (a table of tables of pairs {x, z}; default none): More closed curves; the solid follows the even-odd rule.
---@field from? number from (a number; default 0): Height of the bottom.
---@field to? number to (a number; default from + 1): Height of the top.
---@field spline? 'linear'|'catmull-rom'|'b-spline'|'bezier' spline ('linear'|'catmull-rom'|'b-spline'|'bezier'; default 'linear'): Kind of spline through the points; bezier needs 3 n points.
---@field edge? number edge (a number, >= 0; default 0): Radius of its rounded edges; 0: they are sharp.
---@field chamfer? boolean chamfer (true or false; default false): Whether edges are cut at 45 degrees instead, so far from them.

---An extrusion: an outline along y, with holes.
---@param material gr.material material (a material; default plain gray): Material of the surface.
---@param outline number[][] outline (a table of pairs {u, v}): A closed curve: pairs of x and z.
---@return gr.node
---@overload fun(name: string, outline: number[][]): gr.node
---@overload fun(fields: gr.prism.fields): gr.node
function gr.prism(material, outline) end

---@class gr.sweep.fields
---@field name? string name (a string; default 'sweep'): Name of the node, for messages.
---@field material? gr.material material (a material; default plain gray): Material of the surface.
---@field thin_walled? boolean thin_walled (true or false; default whether it is open): Whether a transparent surface is a thin wall, which light passes straight on, for paths and photons.
---@field medium? gr.medium medium (a medium; default none): Fills the solid, instead of a material or behind its surface.
---@field points gr.triple[] points (a table of points {x, y, z}): Path of the centre of the ball.
---@field radii number|number[] radii (a number or a table of numbers, >= 0): Radius at each point, or one for all.
---@field spline? 'linear'|'catmull-rom'|'b-spline'|'bezier' spline ('linear'|'catmull-rom'|'b-spline'|'bezier'; default 'catmull-rom'): Kind of spline through the points; bezier needs 3 n + 1 points.
---@field loop? boolean loop (true or false; default false): Whether the path is closed.

---A sphere sweep: the volume of a ball that moves along a spline.
---@param material gr.material material (a material; default plain gray): Material of the surface.
---@param points gr.triple[] points (a table of points {x, y, z}): Path of the centre of the ball.
---@param radii number|number[] radii (a number or a table of numbers, >= 0): Radius at each point, or one for all.
---@param spline? 'linear'|'catmull-rom'|'b-spline'|'bezier' spline ('linear'|'catmull-rom'|'b-spline'|'bezier'; default 'catmull-rom'): Kind of spline through the points; bezier needs 3 n + 1 points.
---@return gr.node
---@overload fun(name: string, points: gr.triple[], radii: number|number[], spline?: 'linear'|'catmull-rom'|'b-spline'|'bezier'): gr.node
---@overload fun(fields: gr.sweep.fields): gr.node
function gr.sweep(material, points, radii, spline) end

---@class gr.height_field.fields
---@field name? string name (a string; default 'height field'): Name of the node, for messages.
---@field material? gr.material material (a material; default plain gray): Material of the surface.
---@field thin_walled? boolean thin_walled (true or false; default whether it is open): Whether a transparent surface is a thin wall, which light passes straight on, for paths and photons.
---@field medium? gr.medium medium (a medium; default none): Fills the solid, instead of a material or behind its surface.
---@field heights? number[][] heights (a table of tables of numbers; optional): Rows of heights, all of one length; x varies within a row, z from row to row.
---@field image? string|gr.texture image (the name of a picture file or a texture; optional): A picture instead of heights: black is 0, white is 1, the upper edge is z = 0.
---@field f? function|gr.texture f (a function; optional): A function of the point {x, 0, z}: its height, or an offset that is added to heights or image.
---@field columns? integer columns (a whole number, 2 to 32768; default 257): Points along x at which f is evaluated, without heights and image.
---@field rows? integer rows (a whole number, 2 to 32768; default columns): Points along z.
---@field floor? number floor (a number; default a tenth of the height range below the lowest point): Height of the floor of the solid.
---@field open? boolean open (true or false; default false): Whether it has no walls and no floor.
---@field smooth? boolean smooth (true or false; default false): Whether normals are interpolated.

---A height field over the square from 0 to 1 in x and z, solid down to its floor.
---@param material gr.material material (a material; default plain gray): Material of the surface.
---@param heights number[][] heights (a table of tables of numbers; optional): Rows of heights, all of one length; x varies within a row, z from row to row.
---@return gr.node
---@overload fun(name: string, heights: number[][]): gr.node
---@overload fun(fields: gr.height_field.fields): gr.node
function gr.height_field(material, heights) end

---@class gr.blob.fields
---@field name? string name (a string; default 'blob'): Name of the node, for messages.
---@field material? gr.material material (a material; default plain gray): Material of the surface.
---@field thin_walled? boolean thin_walled (true or false; default whether it is open): Whether a transparent surface is a thin wall, which light passes straight on, for paths and photons.
---@field medium? gr.medium medium (a medium; default none): Fills the solid, instead of a material or behind its surface.
---@field spheres? number[][] spheres (a table of tables of numbers; default {}): Balls {x, y, z, radius, strength}; the default strength is 1.
---@field cylinders? number[][] cylinders (a table of tables of numbers; default {}): Rods {x1, y1, z1, x2, y2, z2, radius, strength}; the default strength is 1.
---@field threshold? number threshold (a number, > 0; default 0.5): The surface is where the sum of the fields strength (1 - (distance/radius)^2)^2 has this value.

---A blob (metaballs): the isosurface of the fields of balls and rods.
---@param material gr.material material (a material; default plain gray): Material of the surface.
---@param spheres number[][] spheres (a table of tables of numbers; default {}): Balls {x, y, z, radius, strength}; the default strength is 1.
---@param cylinders? number[][] cylinders (a table of tables of numbers; default {}): Rods {x1, y1, z1, x2, y2, z2, radius, strength}; the default strength is 1.
---@param threshold? number threshold (a number, > 0; default 0.5): The surface is where the sum of the fields strength (1 - (distance/radius)^2)^2 has this value.
---@return gr.node
---@overload fun(name: string, spheres: number[][], cylinders?: number[][], threshold?: number): gr.node
---@overload fun(fields: gr.blob.fields): gr.node
function gr.blob(material, spheres, cylinders, threshold) end

---@class gr.implicit.fields
---@field name? string name (a string; default 'implicit'): Name of the node, for messages.
---@field material? gr.material material (a material; default plain gray): Material of the surface.
---@field thin_walled? boolean thin_walled (true or false; default whether it is open): Whether a transparent surface is a thin wall, which light passes straight on, for paths and photons.
---@field medium? gr.medium medium (a medium; default none): Fills the solid, instead of a material or behind its surface.
---@field f function|gr.texture f (a function): A function of a point that is negative inside.
---@field bounds? gr.triple[] bounds (a table of points {x, y, z}; default a ball, if radius is given): Two corners {min, max} of the box that bounds it.
---@field radius? number radius (a number, > 0; optional): Radius of a ball that bounds it, instead of bounds.
---@field centre? gr.triple centre (a point {x, y, z}; default {0, 0, 0}): Centre of that ball.
---@field open? boolean open (true or false; default false): Whether there are no caps on the bounds.
---@field lipschitz? number lipschitz (a number, > 0; optional): A bound of the slope of f: |f(a) - f(b)| <= lipschitz |a - b|.
---@field distance? boolean distance (true or false; default false): Whether |f| is at most the distance to the surface.

---An implicit solid: the points in a box or a ball where a function is negative.
---@param material gr.material material (a material; default plain gray): Material of the surface.
---@param f function|gr.texture f (a function): A function of a point that is negative inside.
---@param bounds gr.triple[] bounds (a table of points {x, y, z}; default a ball, if radius is given): Two corners {min, max} of the box that bounds it.
---@return gr.node
---@overload fun(name: string, f: function|gr.texture, bounds: gr.triple[]): gr.node
---@overload fun(fields: gr.implicit.fields): gr.node
function gr.implicit(material, f, bounds) end

---@class gr.curve.fields
---@field name? string name (a string; default 'curve'): Name of the node, for messages.
---@field material? gr.material material (a material; default plain gray): Material of the surface.
---@field thin_walled? boolean thin_walled (true or false; default whether it is open): Whether a transparent surface is a thin wall, which light passes straight on, for paths and photons.
---@field medium? gr.medium medium (a medium; default none): Fills the solid, instead of a material or behind its surface.
---@field points gr.triple[] points (a table of points {x, y, z}): Path of the curve.
---@field widths number|number[] widths (a number or a table of numbers, >= 0): Width at each point, or one for all.
---@field spline? 'linear'|'catmull-rom'|'b-spline'|'bezier' spline ('linear'|'catmull-rom'|'b-spline'|'bezier'; default 'catmull-rom'): Kind of spline through the points; bezier needs 3 n + 1 points.
---@field flat? boolean flat (true or false; default false): Whether it is shaded as a flat ribbon instead of a round hair.

---A hair: a ribbon along a spline that faces each ray.
---@param material gr.material material (a material; default plain gray): Material of the surface.
---@param points gr.triple[] points (a table of points {x, y, z}): Path of the curve.
---@param widths number|number[] widths (a number or a table of numbers, >= 0): Width at each point, or one for all.
---@param spline? 'linear'|'catmull-rom'|'b-spline'|'bezier' spline ('linear'|'catmull-rom'|'b-spline'|'bezier'; default 'catmull-rom'): Kind of spline through the points; bezier needs 3 n + 1 points.
---@return gr.node
---@overload fun(name: string, points: gr.triple[], widths: number|number[], spline?: 'linear'|'catmull-rom'|'b-spline'|'bezier'): gr.node
---@overload fun(fields: gr.curve.fields): gr.node
function gr.curve(material, points, widths, spline) end

---@class gr.patch.fields
---@field name? string name (a string; default 'patch'): Name of the node, for messages.
---@field material? gr.material material (a material; default plain gray): Material of the surface.
---@field thin_walled? boolean thin_walled (true or false; default whether it is open): Whether a transparent surface is a thin wall, which light passes straight on, for paths and photons.
---@field medium? gr.medium medium (a medium; default none): Fills the solid, instead of a material or behind its surface.
---@field points gr.triple[] points (a table of points {x, y, z}): Control points, 16 for each patch, in 4 rows of 4.
---@field patches? integer[][] patches (a table of tuples of indices; default 16 points each, in order): Tuples of 16 indices into points, from 0.
---@field tolerance? number tolerance (a number, > 0; default a thousandth of the size): Largest distance of the triangles from the exact surface.
---@field flip? boolean flip (true or false; default false): Whether the front is reversed.

---Bicubic Bezier patches, as a mesh.
---@param material gr.material material (a material; default plain gray): Material of the surface.
---@param points gr.triple[] points (a table of points {x, y, z}): Control points, 16 for each patch, in 4 rows of 4.
---@param patches? integer[][] patches (a table of tuples of indices; default 16 points each, in order): Tuples of 16 indices into points, from 0.
---@return gr.node
---@overload fun(name: string, points: gr.triple[], patches?: integer[][]): gr.node
---@overload fun(fields: gr.patch.fields): gr.node
function gr.patch(material, points, patches) end

---@class gr.node.displace.fields
---@field f? function|gr.texture f (a function; optional): A function f(p, s) of a vertex: the distance along its normal, or an offset {x, y, z}.
---@field edge? number edge (a number, > 0; default a part of the extent): Longer edges are halved, until none is longer, before vertices move.
---@field level? integer level (a whole number, 0 to 12; default edge): Instead of edge: how often every edge is halved.
---@field smooth? number smooth (a number, 0 to 180, in degrees; default 60): Crease angle of the displaced mesh, as in gr.mesh; 0: all faces are flat.

---Divides meshes, patches and height fields into small triangles and moves their vertices by a function.
---@param f function|gr.texture f (a function; optional): A function f(p, s) of a vertex: the distance along its normal, or an offset {x, y, z}.
---@param edge? number edge (a number, > 0; default a part of the extent): Longer edges are halved, until none is longer, before vertices move.
---@return gr.node
---@overload fun(self: gr.node, fields: gr.node.displace.fields): gr.node
function node:displace(f, edge) end

---@class gr.fn.fields
---@field f number|gr.triple|gr.texture|function f (a number or a table of 3 numbers or a texture): A Lua function f(p, s) of the point, or anything else that is a texture.
---@field points? integer points (a whole number, 1 to 16; default 16): Maximum number of points of a pixel's footprint over which the function is averaged: 1, 2, 4, 8 or 16.

---A Lua function as a texture. Every argument that accepts a texture also accepts a function.
---@param f number|gr.triple|gr.texture|function f (a number or a table of 3 numbers or a texture): A Lua function f(p, s) of the point, or anything else that is a texture.
---@param points? integer points (a whole number, 1 to 16; default 16): Maximum number of points of a pixel's footprint over which the function is averaged: 1, 2, 4, 8 or 16.
---@return gr.texture
---@overload fun(fields: gr.fn.fields): gr.texture
function gr.fn(f, points) end

---@class gr.program.fields
---@field code string code (a string): Its operations, such as 'v0 = p.x; v1 = sin v0; result v1'.
---@field image1? string|gr.texture image1 (the name of a picture file or a texture; default none): A picture that texel reads.
---@field image2? string|gr.texture image2 (the name of a picture file or a texture; default none): A picture that texel reads.
---@field image3? string|gr.texture image3 (the name of a picture file or a texture; default none): A picture that texel reads.
---@field image4? string|gr.texture image4 (the name of a picture file or a texture; default none): A picture that texel reads.

---A function as the text of its operations, as gray writes it into scenes of JSON.
---@param code string code (a string): Its operations, such as 'v0 = p.x; v1 = sin v0; result v1'.
---@return gr.texture
---@overload fun(fields: gr.program.fields): gr.texture
function gr.program(code) end

---@class gr.marble_texture.fields
---@field f number f (a number): Factor of the point before the noise.
---@field multiplier number multiplier (a number): Strength of the noise in the veins.
---@field vein_frequency number vein_frequency (a number): Frequency of the veins along y.
---@field interp? integer interp (a whole number, 0 to 1; default 0): Interpolation of the noise: 0 linear, 1 cosine.

---A marble pattern between 0 and 1, for inputs of gr.material.
---@param f number f (a number): Factor of the point before the noise.
---@param multiplier number multiplier (a number): Strength of the noise in the veins.
---@param vein_frequency number vein_frequency (a number): Frequency of the veins along y.
---@param interp? integer interp (a whole number, 0 to 1; default 0): Interpolation of the noise: 0 linear, 1 cosine.
---@return gr.texture
---@overload fun(fields: gr.marble_texture.fields): gr.texture
function gr.marble_texture(f, multiplier, vein_frequency, interp) end

---@class gr.wood_texture.fields
---@field f number f (a number): Factor of the point before the noise.
---@field density number density (a number): Density of the grain.
---@field interp? integer interp (a whole number, 0 to 1; default 0): Interpolation of the noise: 0 linear, 1 cosine.

---A wood pattern between 0 and 1, for inputs of gr.material.
---@param f number f (a number): Factor of the point before the noise.
---@param density number density (a number): Density of the grain.
---@param interp? integer interp (a whole number, 0 to 1; default 0): Interpolation of the noise: 0 linear, 1 cosine.
---@return gr.texture
---@overload fun(fields: gr.wood_texture.fields): gr.texture
function gr.wood_texture(f, density, interp) end

---@class gr.mix_texture.fields
---@field a number|gr.triple|gr.texture|function a (a number or a table of 3 numbers or a texture): Value where ratio is 1: a number, a colour or a texture.
---@field b number|gr.triple|gr.texture|function b (a number or a table of 3 numbers or a texture): Value where ratio is 0.
---@field ratio? number|gr.texture|function ratio (a number or a texture; default 0.5): Weight of a: the result is a * ratio + b * (1 - ratio).

---A mix of two textures or colours.
---@param a number|gr.triple|gr.texture|function a (a number or a table of 3 numbers or a texture): Value where ratio is 1: a number, a colour or a texture.
---@param b number|gr.triple|gr.texture|function b (a number or a table of 3 numbers or a texture): Value where ratio is 0.
---@param ratio? number|gr.texture|function ratio (a number or a texture; default 0.5): Weight of a: the result is a * ratio + b * (1 - ratio).
---@return gr.texture
---@overload fun(fields: gr.mix_texture.fields): gr.texture
function gr.mix_texture(a, b, ratio) end

---@class gr.multiply_texture.fields
---@field a number|gr.triple|gr.texture|function a (a number or a table of 3 numbers or a texture): One factor: a number, a colour or a texture.
---@field b number|gr.triple|gr.texture|function b (a number or a table of 3 numbers or a texture): The other factor.

---The product of two textures or colours.
---@param a number|gr.triple|gr.texture|function a (a number or a table of 3 numbers or a texture): One factor: a number, a colour or a texture.
---@param b number|gr.triple|gr.texture|function b (a number or a table of 3 numbers or a texture): The other factor.
---@return gr.texture
---@overload fun(fields: gr.multiply_texture.fields): gr.texture
function gr.multiply_texture(a, b) end

---@class gr.material.fields
---@field kd gr.triple|string|gr.texture|function kd (a colour {r, g, b} or a texture): Diffuse and ambient colour.
---@field ks? gr.triple|string|gr.texture|function ks (a colour {r, g, b} or a texture; default {0, 0, 0}): Colour of highlights; filter of reflected and refracted rays.
---@field shininess? number|gr.texture|function shininess (a number or a texture, >= 0; default 1): Exponent of the highlight.
---@field reflect? number|gr.texture|function reflect (a number or a texture, 0 to 1; default 0): Amount of reflection.
---@field refract? number|gr.texture|function refract (a number or a texture, 0 to 1; default 0): Amount of refraction.
---@field ior? number ior (a number, >= 1; default none): Index of refraction inside the solid.
---@field two_sided? boolean two_sided (true or false; default false): Whether faces seen from behind are lit, too.
---@field highlight? 'phong'|'blinn' highlight ('phong'|'blinn'; default specular of the render): Formula of the highlight.
---@field lit? boolean lit (true or false; default true): Whether light affects it; false: it shows kd unchanged.
---@field emission? gr.triple|string|gr.texture|function emission (a colour {r, g, b} or a texture; default {0, 0, 0}): Emitted light, added to reflected light.
---@field roughness? number|gr.texture|function roughness (a number or a texture, 0 to 1; default 0): Roughness of reflection and refraction; 0 is polished.
---@field glossy_samples? integer glossy_samples (a whole number, 1 to 64; default 4): N x N rays from a rough surface; after the first rough surface of a path, one ray.
---@field absorption? gr.triple|string absorption (a colour {r, g, b}, >= 0; default {0, 0, 0}): Absorption inside the solid: factor exp(-absorption * distance).
---@field opacity? number|gr.texture|function opacity (a number or a texture, 0 to 1; default 1): Opacity of the surface; below 1 it has holes.
---@field metalness? number|gr.texture|function metalness (a number or a texture, 0 to 1; default 0): Fraction of kd that replaces ks.
---@field bump? string|gr.texture|function bump (the name of a picture file or a texture; default none): Heights: a result of gr.bump, a file or a texture.
---@field glass? 'N-BK7'|'N-BK10'|'N-K5'|'N-FK5'|'N-FK51A'|'N-BAK4'|'N-SK16'|'N-BAF10'|'N-LASF9'|'F2'|'N-F2'|'N-SF5'|'N-SF10'|'N-SF11'|'SF11'|'SF10'|'N-SF6'|'N-SF66'|'silica'|'fluorite'|'sapphire'|'diamond'|'water' glass ('N-BK7', 'N-BK10', 'N-K5', 'N-FK5', 'N-FK51A', 'N-BAK4', 'N-SK16', 'N-BAF10', 'N-LASF9', 'F2', 'N-F2', 'N-SF5', 'N-SF10', 'N-SF11', 'SF11', 'SF10', 'N-SF6', 'N-SF66', 'silica', 'fluorite', 'sapphire', 'diamond', 'water'; default none): A glass by its name: its index and its dispersion.

---A Phong material.
---@param kd gr.triple|string|gr.texture|function kd (a colour {r, g, b} or a texture): Diffuse and ambient colour.
---@param ks? gr.triple|string|gr.texture|function ks (a colour {r, g, b} or a texture; default {0, 0, 0}): Colour of highlights; filter of reflected and refracted rays.
---@param shininess? number|gr.texture|function shininess (a number or a texture, >= 0; default 1): Exponent of the highlight.
---@return gr.material
---@overload fun(fields: gr.material.fields): gr.material
function gr.material(kd, ks, shininess) end

---@class gr.rr_material.fields
---@field kd gr.triple|string|gr.texture|function kd (a colour {r, g, b} or a texture): Diffuse and ambient colour.
---@field ks? gr.triple|string|gr.texture|function ks (a colour {r, g, b} or a texture; default {0, 0, 0}): Colour of highlights; filter of reflected and refracted rays.
---@field shininess? number|gr.texture|function shininess (a number or a texture, >= 0; default 1): Exponent of the highlight.
---@field reflect? number|gr.texture|function reflect (a number or a texture, 0 to 1; default 0): Amount of reflection.
---@field refract? number|gr.texture|function refract (a number or a texture, 0 to 1; default 0): Amount of refraction.
---@field ior? number ior (a number, >= 1; default 1): Index of refraction inside the solid.
---@field two_sided? boolean two_sided (true or false; default false): Whether faces seen from behind are lit, too.
---@field highlight? 'phong'|'blinn' highlight ('phong'|'blinn'; default specular of the render): Formula of the highlight.
---@field lit? boolean lit (true or false; default true): Whether light affects it; false: it shows kd unchanged.
---@field emission? gr.triple|string|gr.texture|function emission (a colour {r, g, b} or a texture; default {0, 0, 0}): Emitted light, added to reflected light.
---@field roughness? number|gr.texture|function roughness (a number or a texture, 0 to 1; default 0): Roughness of reflection and refraction; 0 is polished.
---@field glossy_samples? integer glossy_samples (a whole number, 1 to 64; default 4): N x N rays from a rough surface; after the first rough surface of a path, one ray.
---@field absorption? gr.triple|string absorption (a colour {r, g, b}, >= 0; default {0, 0, 0}): Absorption inside the solid: factor exp(-absorption * distance).
---@field opacity? number|gr.texture|function opacity (a number or a texture, 0 to 1; default 1): Opacity of the surface; below 1 it has holes.
---@field metalness? number|gr.texture|function metalness (a number or a texture, 0 to 1; default 0): Fraction of kd that replaces ks.
---@field bump? string|gr.texture|function bump (the name of a picture file or a texture; default none): Heights: a result of gr.bump, a file or a texture.
---@field glass? 'N-BK7'|'N-BK10'|'N-K5'|'N-FK5'|'N-FK51A'|'N-BAK4'|'N-SK16'|'N-BAF10'|'N-LASF9'|'F2'|'N-F2'|'N-SF5'|'N-SF10'|'N-SF11'|'SF11'|'SF10'|'N-SF6'|'N-SF66'|'silica'|'fluorite'|'sapphire'|'diamond'|'water' glass ('N-BK7', 'N-BK10', 'N-K5', 'N-FK5', 'N-FK51A', 'N-BAK4', 'N-SK16', 'N-BAF10', 'N-LASF9', 'F2', 'N-F2', 'N-SF5', 'N-SF10', 'N-SF11', 'SF11', 'SF10', 'N-SF6', 'N-SF66', 'silica', 'fluorite', 'sapphire', 'diamond', 'water'; default none): A glass by its name: its index and its dispersion.

---A Phong material that reflects and refracts.
---@param kd gr.triple|string|gr.texture|function kd (a colour {r, g, b} or a texture): Diffuse and ambient colour.
---@param ks gr.triple|string|gr.texture|function ks (a colour {r, g, b} or a texture; default {0, 0, 0}): Colour of highlights; filter of reflected and refracted rays.
---@param shininess number|gr.texture|function shininess (a number or a texture, >= 0; default 1): Exponent of the highlight.
---@param reflect number|gr.texture|function reflect (a number or a texture, 0 to 1; default 0): Amount of reflection.
---@param refract number|gr.texture|function refract (a number or a texture, 0 to 1; default 0): Amount of refraction.
---@param ior number ior (a number, >= 1; default 1): Index of refraction inside the solid.
---@return gr.material
---@overload fun(fields: gr.rr_material.fields): gr.material
function gr.rr_material(kd, ks, shininess, reflect, refract, ior) end

---@class gr.marble_pnd_material.fields
---@field material gr.material material (a material): The base material.
---@field f number f (a number): Factor of the point before the noise.
---@field multiplier number multiplier (a number): Strength of the noise in the veins.
---@field vein_frequency number vein_frequency (a number): Frequency of the veins along y.
---@field interp? integer interp (a whole number, 0 to 1; default 0): Interpolation of the noise: 0 linear, 1 cosine.
---@field mix gr.triple|string mix (a colour {r, g, b}): Colour to mix with kd.

---Marble over another material.
---@param material gr.material material (a material): The base material.
---@param f number f (a number): Factor of the point before the noise.
---@param multiplier number multiplier (a number): Strength of the noise in the veins.
---@param vein_frequency number vein_frequency (a number): Frequency of the veins along y.
---@param interp integer interp (a whole number, 0 to 1; default 0): Interpolation of the noise: 0 linear, 1 cosine.
---@param mix gr.triple|string mix (a colour {r, g, b}): Colour to mix with kd.
---@return gr.material
---@overload fun(fields: gr.marble_pnd_material.fields): gr.material
function gr.marble_pnd_material(material, f, multiplier, vein_frequency, interp, mix) end

---@class gr.wood_pnd_material.fields
---@field material gr.material material (a material): The base material.
---@field f number f (a number): Factor of the point before the noise.
---@field density number density (a number): Density of the grain.
---@field interp? integer interp (a whole number, 0 to 1; default 0): Interpolation of the noise: 0 linear, 1 cosine.
---@field mix gr.triple|string mix (a colour {r, g, b}): Colour to mix with kd.

---Wood over another material.
---@param material gr.material material (a material): The base material.
---@param f number f (a number): Factor of the point before the noise.
---@param density number density (a number): Density of the grain.
---@param interp integer interp (a whole number, 0 to 1; default 0): Interpolation of the noise: 0 linear, 1 cosine.
---@param mix gr.triple|string mix (a colour {r, g, b}): Colour to mix with kd.
---@return gr.material
---@overload fun(fields: gr.wood_pnd_material.fields): gr.material
function gr.wood_pnd_material(material, f, density, interp, mix) end

---@class gr.td_cube_material.fields
---@field material gr.material material (a material): The base material.
---@field png string|gr.texture png (the name of a picture file or a texture): A picture file, or a texture.
---@field filter? 'nearest'|'bilinear'|'mipmap' filter ('nearest'|'bilinear'|'mipmap'; default 'mipmap'): Filter of the lookup.
---@field flip_u? boolean flip_u (true or false; default false): Whether the image is mirrored from left to right.
---@field mapping? 'classic'|'outside' mapping ('classic'|'outside'; default 'classic'): On spheres: classic is mirrored, seen from outside; outside is not.

---An image on each side of the unit cube, over another material.
---@param material gr.material material (a material): The base material.
---@param png string|gr.texture png (the name of a picture file or a texture): A picture file, or a texture.
---@return gr.material
---@overload fun(fields: gr.td_cube_material.fields): gr.material
function gr.td_cube_material(material, png) end

---@class gr.td_sphere_material.fields
---@field material gr.material material (a material): The base material.
---@field png string|gr.texture png (the name of a picture file or a texture): A picture file, or a texture.
---@field filter? 'nearest'|'bilinear'|'mipmap' filter ('nearest'|'bilinear'|'mipmap'; default 'mipmap'): Filter of the lookup.
---@field flip_u? boolean flip_u (true or false; default false): Whether the image is mirrored from left to right.
---@field mapping? 'classic'|'outside' mapping ('classic'|'outside'; default 'classic'): On spheres: classic is mirrored, seen from outside; outside is not.

---An image around the unit sphere, over another material.
---@param material gr.material material (a material): The base material.
---@param png string|gr.texture png (the name of a picture file or a texture): A picture file, or a texture.
---@return gr.material
---@overload fun(fields: gr.td_sphere_material.fields): gr.material
function gr.td_sphere_material(material, png) end

---@class gr.difresnel_material.fields
---@field material gr.material material (a material): The base material.

---A dielectric: reflects and refracts by Fresnel's equations.
---@param material gr.material material (a material): The base material.
---@return gr.material
---@overload fun(fields: gr.difresnel_material.fields): gr.material
function gr.difresnel_material(material) end

---@class gr.difresneld_material.fields
---@field material gr.material material (a material): The base material.

---The same as gr.difresnel_material.
---@param material gr.material material (a material): The base material.
---@return gr.material
---@overload fun(fields: gr.difresneld_material.fields): gr.material
function gr.difresneld_material(material) end

---@class gr.texture.fields
---@field file string|gr.texture file (the name of a picture file or a texture): A picture file.
---@field filter? 'nearest'|'bilinear'|'mipmap' filter ('nearest'|'bilinear'|'mipmap'; default 'mipmap'): Filter of the lookup.
---@field wrap? 'clamp'|'repeat'|'mirror' wrap ('clamp'|'repeat'|'mirror'; default 'repeat'): Lookup outside of the image.
---@field flip_u? boolean flip_u (true or false; default false): Whether the image is mirrored from left to right.
---@field tiles? number|number[] tiles (a number or a table of 2 numbers; default 1): Number of repetitions: one number, or {across, up}.
---@field offset? number|number[] offset (a number or a table of 2 numbers; default 0): Shift in units of the image: one number, or {across, up}.
---@field encoding? 'auto'|'srgb'|'linear'|number encoding ('auto'|'srgb'|'linear', > 0 and <= 10; default 'auto'): Meaning of its numbers for linear colours; auto: as the file states, otherwise sRGB for colours of 8 bits; a number is a gamma.
---@field mapping? 'classic'|'outside' mapping ('classic'|'outside'; default 'classic'): On spheres: classic is mirrored, seen from outside; outside is not.
---@field alpha? boolean alpha (true or false; default false): Whether the alpha of the picture is the opacity of the surface.

---An image texture for node:set_texture and for inputs of gr.material.
---@param file string|gr.texture file (the name of a picture file or a texture): A picture file.
---@return gr.texture
---@overload fun(fields: gr.texture.fields): gr.texture
function gr.texture(file) end

---@class gr.bump.fields
---@field file string|gr.texture|function file (the name of a picture file or a texture): A picture file, or any texture.
---@field filter? 'nearest'|'bilinear'|'mipmap' filter ('nearest'|'bilinear'|'mipmap'; default 'mipmap'): Filter of the lookup.
---@field wrap? 'clamp'|'repeat'|'mirror' wrap ('clamp'|'repeat'|'mirror'; default 'repeat'): Lookup outside of the image.
---@field flip_u? boolean flip_u (true or false; default false): Whether the image is mirrored from left to right.
---@field tiles? number|number[] tiles (a number or a table of 2 numbers; default 1): Number of repetitions: one number, or {across, up}.
---@field offset? number|number[] offset (a number or a table of 2 numbers; default 0): Shift in units of the image: one number, or {across, up}.
---@field encoding? 'auto'|'srgb'|'linear'|number encoding ('auto'|'srgb'|'linear', > 0 and <= 10; default 'auto'): Meaning of its numbers for linear colours; auto: as the file states, otherwise sRGB for colours of 8 bits; a number is a gamma.
---@field mapping? 'classic'|'outside' mapping ('classic'|'outside'; default 'classic'): On spheres: classic is mirrored, seen from outside; outside is not.
---@field height? number height (a number; default 1/50 of the picture's size; 1 for normals): Height of white above black, in units of the object; for normals, a factor of the slopes.
---@field kind? 'bump'|'normal' kind ('bump'|'normal'; default 'bump'): Contents: heights, or normals as colours (x right, y up, z outwards).

---A bump map or normal map for node:set_bump.
---@param file string|gr.texture|function file (the name of a picture file or a texture): A picture file, or any texture.
---@param height? number height (a number; default 1/50 of the picture's size; 1 for normals): Height of white above black, in units of the object; for normals, a factor of the slopes.
---@return gr.texture
---@overload fun(fields: gr.bump.fields): gr.texture
function gr.bump(file, height) end

---@class gr.image_material.fields
---@field material gr.material material (a material): The base material.
---@field image string|gr.texture image (the name of a picture file or a texture): A picture file, or a texture.
---@field filter? 'nearest'|'bilinear'|'mipmap' filter ('nearest'|'bilinear'|'mipmap'; default 'mipmap'): Filter of the lookup.
---@field wrap? 'clamp'|'repeat'|'mirror' wrap ('clamp'|'repeat'|'mirror'; default 'repeat'): Lookup outside of the image.
---@field flip_u? boolean flip_u (true or false; default false): Whether the image is mirrored from left to right.
---@field tiles? number|number[] tiles (a number or a table of 2 numbers; default 1): Number of repetitions: one number, or {across, up}.
---@field offset? number|number[] offset (a number or a table of 2 numbers; default 0): Shift in units of the image: one number, or {across, up}.
---@field encoding? 'auto'|'srgb'|'linear'|number encoding ('auto'|'srgb'|'linear', > 0 and <= 10; default 'auto'): Meaning of its numbers for linear colours; auto: as the file states, otherwise sRGB for colours of 8 bits; a number is a gamma.
---@field mapping? 'classic'|'outside' mapping ('classic'|'outside'; default 'classic'): On spheres: classic is mirrored, seen from outside; outside is not.
---@field channel? 'kd'|'ks'|'emission'|'opacity' channel ('kd'|'ks'|'emission'|'opacity'; default 'kd'): The input that the image replaces; where opacity is below 1, the surface has holes.

---An image mapped by the texture coordinates of the shape, over another material.
---@param material gr.material material (a material): The base material.
---@param image string|gr.texture image (the name of a picture file or a texture): A picture file, or a texture.
---@return gr.material
---@overload fun(fields: gr.image_material.fields): gr.material
function gr.image_material(material, image) end

---@class gr.bump_material.fields
---@field material gr.material material (a material): The base material.
---@field image string|gr.texture|function image (the name of a picture file or a texture): A picture file, or a result of gr.bump.
---@field filter? 'nearest'|'bilinear'|'mipmap' filter ('nearest'|'bilinear'|'mipmap'; default 'mipmap'): Filter of the lookup.
---@field wrap? 'clamp'|'repeat'|'mirror' wrap ('clamp'|'repeat'|'mirror'; default 'repeat'): Lookup outside of the image.
---@field flip_u? boolean flip_u (true or false; default false): Whether the image is mirrored from left to right.
---@field tiles? number|number[] tiles (a number or a table of 2 numbers; default 1): Number of repetitions: one number, or {across, up}.
---@field offset? number|number[] offset (a number or a table of 2 numbers; default 0): Shift in units of the image: one number, or {across, up}.
---@field encoding? 'auto'|'srgb'|'linear'|number encoding ('auto'|'srgb'|'linear', > 0 and <= 10; default 'auto'): Meaning of its numbers for linear colours; auto: as the file states, otherwise sRGB for colours of 8 bits; a number is a gamma.
---@field mapping? 'classic'|'outside' mapping ('classic'|'outside'; default 'classic'): On spheres: classic is mirrored, seen from outside; outside is not.
---@field height? number height (a number; default 1/50 of the picture's size; 1 for normals): Height of white above black, in units of the object; for normals, a factor of the slopes.
---@field kind? 'bump'|'normal' kind ('bump'|'normal'; default 'bump'): Contents: heights, or normals as colours (x right, y up, z outwards).

---A bump map or normal map over another material.
---@param material gr.material material (a material): The base material.
---@param image string|gr.texture|function image (the name of a picture file or a texture): A picture file, or a result of gr.bump.
---@param height? number height (a number; default 1/50 of the picture's size; 1 for normals): Height of white above black, in units of the object; for normals, a factor of the slopes.
---@return gr.material
---@overload fun(fields: gr.bump_material.fields): gr.material
function gr.bump_material(material, image, height) end

---@class gr.glyphs.fields
---@field font string font (the name of a file): A font file: TrueType, OpenType or Type 1.
---@field text string text (a string): One line of text, in UTF-8.

---Outlines of a line of text, in ems: a list of letters with code, x, advance, missing and contours (cubic, for gr.prism), and the fields width, ascender, descender and line.
---@param font string font (the name of a file): A font file: TrueType, OpenType or Type 1.
---@param text string text (a string): One line of text, in UTF-8.
---@return gr.glyphs
---@overload fun(fields: gr.glyphs.fields): gr.glyphs
function gr.glyphs(font, text) end

---@class gr.openpbr_material.fields
---@field base_weight? number|gr.texture|function base_weight (a number or a texture, 0 to 1; default 1): Factor of base_color.
---@field base_color? gr.triple|string|gr.texture|function base_color (a colour {r, g, b} or a texture, >= 0; default {0.8, 0.8, 0.8}): Diffuse colour; for metals the reflectance at normal incidence.
---@field base_diffuse_roughness? number|gr.texture|function base_diffuse_roughness (a number or a texture, 0 to 1; default 0): Roughness of the diffuse base; 0 is Lambert's.
---@field base_metalness? number|gr.texture|function base_metalness (a number or a texture, 0 to 1; default 0): Share of the base that is metal.
---@field specular_weight? number|gr.texture|function specular_weight (a number or a texture, >= 0; default 1): Factor of the reflectance at normal incidence; for dielectrics it changes the index.
---@field specular_color? gr.triple|string|gr.texture|function specular_color (a colour {r, g, b} or a texture, >= 0; default {1, 1, 1}): Colour of the specular reflection; for metals the tint at 82 degrees.
---@field specular_roughness? number|gr.texture|function specular_roughness (a number or a texture, 0 to 1; default 0.3): Roughness of reflection and refraction; 0 is polished.
---@field specular_roughness_anisotropy? number|gr.texture|function specular_roughness_anisotropy (a number or a texture, 0 to 1; default 0): How much smoother it is along the tangent than across.
---@field specular_ior? number|gr.texture|function specular_ior (a number or a texture, > 0; default 1.5): Index of refraction of the base.
---@field transmission_weight? number|gr.texture|function transmission_weight (a number or a texture, 0 to 1; default 0): Share of the dielectric base that transmits light.
---@field transmission_color? gr.triple|string|gr.texture|function transmission_color (a colour {r, g, b} or a texture, >= 0; default {1, 1, 1}): Colour of transmitted light, after the distance transmission_depth.
---@field transmission_depth? number transmission_depth (a number, >= 0; default 0): Distance inside the solid after which white light has transmission_color; 0: at the surface.
---@field transmission_scatter? gr.triple|string transmission_scatter (a colour {r, g, b}, >= 0; default {0, 0, 0}): Scattering inside the solid along the distance transmission_depth.
---@field transmission_scatter_anisotropy? number transmission_scatter_anisotropy (a number, > -1 and < 1; default 0): Mean cosine of that scattering.
---@field transmission_dispersion_scale? number transmission_dispersion_scale (a number, >= 0; default 0; 1 with glass): Factor of the dispersion; 0: none.
---@field transmission_dispersion_abbe_number? number transmission_dispersion_abbe_number (a number, > 0; default 20): Abbe's number of the dispersion by Cauchy's law.
---@field subsurface_weight? number|gr.texture|function subsurface_weight (a number or a texture, 0 to 1; default 0): Share of the diffuse base whose light is scattered under the surface.
---@field subsurface_color? gr.triple|string|gr.texture|function subsurface_color (a colour {r, g, b} or a texture, >= 0; default {0.8, 0.8, 0.8}): The colour that a large solid shows by it.
---@field subsurface_radius? number|gr.texture|function subsurface_radius (a number or a texture, >= 0; default 1): Mean free path under the surface; 0 is Lambert's diffuse light.
---@field subsurface_radius_scale? gr.triple|string subsurface_radius_scale (a colour {r, g, b}, >= 0; default {1, 0.5, 0.25}): Factors of subsurface_radius by channel.
---@field subsurface_scatter_anisotropy? number subsurface_scatter_anisotropy (a number, > -1 and < 1; default 0): Mean cosine of that scattering.
---@field coat_weight? number|gr.texture|function coat_weight (a number or a texture, 0 to 1; default 0): Share of the surface with a clear coat.
---@field coat_color? gr.triple|string|gr.texture|function coat_color (a colour {r, g, b} or a texture, >= 0; default {1, 1, 1}): Colour of light that passed the coat twice.
---@field coat_roughness? number|gr.texture|function coat_roughness (a number or a texture, 0 to 1; default 0): Roughness of the coat; 0 is polished.
---@field coat_roughness_anisotropy? number|gr.texture|function coat_roughness_anisotropy (a number or a texture, 0 to 1; default 0): The same for the coat.
---@field coat_ior? number|gr.texture|function coat_ior (a number or a texture, > 0; default 1.6): Index of refraction of the coat.
---@field coat_darkening? number|gr.texture|function coat_darkening (a number or a texture, 0 to 1; default 1): How much internal reflections of the coat darken the base.
---@field fuzz_weight? number|gr.texture|function fuzz_weight (a number or a texture, 0 to 1; default 0): Share of the surface with fuzz.
---@field fuzz_color? gr.triple|string|gr.texture|function fuzz_color (a colour {r, g, b} or a texture, >= 0; default {1, 1, 1}): Colour of the fuzz.
---@field fuzz_roughness? number|gr.texture|function fuzz_roughness (a number or a texture, 0 to 1; default 0.5): Roughness of the fuzz; a rough fuzz is visible farther from the rim.
---@field emission_luminance? number|gr.texture|function emission_luminance (a number or a texture, >= 0; default 0): Emitted light, below coat and fuzz; 1 means radiance 1.
---@field emission_color? gr.triple|string|gr.texture|function emission_color (a colour {r, g, b} or a texture, >= 0; default {1, 1, 1}): Its colour.
---@field thin_film_weight? number|gr.texture|function thin_film_weight (a number or a texture, 0 to 1; default 0): Share of the base with a film that shows colours of interference.
---@field thin_film_thickness? number|gr.texture|function thin_film_thickness (a number or a texture, >= 0; default 0.5): Its thickness in micrometres; 0: no film.
---@field thin_film_ior? number thin_film_ior (a number, > 0; default 1.4): Its index of refraction.
---@field geometry_opacity? number|gr.texture|function geometry_opacity (a number or a texture, 0 to 1; default 1): Opacity of the surface; below 1 it has holes.
---@field geometry_thin_walled? boolean geometry_thin_walled (true or false; default false): Whether the surface is a wall without thickness: nothing is inside.
---@field geometry_normal? string|gr.texture|function geometry_normal (the name of a picture file or a texture; default none): A normal map or bump map: a result of gr.bump, or the file of a normal map.
---@field geometry_tangent? gr.triple geometry_tangent (a direction {x, y, z}; default along u): Direction along which the facets of an anisotropic surface are smooth, in the world.
---@field geometry_coat_normal? string|gr.texture|function geometry_coat_normal (the name of a picture file or a texture; default that of the base): The same for the coat.
---@field geometry_coat_tangent? gr.triple geometry_coat_tangent (a direction {x, y, z}; default along u): The same for the coat.
---@field glass? 'N-BK7'|'N-BK10'|'N-K5'|'N-FK5'|'N-FK51A'|'N-BAK4'|'N-SK16'|'N-BAF10'|'N-LASF9'|'F2'|'N-F2'|'N-SF5'|'N-SF10'|'N-SF11'|'SF11'|'SF10'|'N-SF6'|'N-SF66'|'silica'|'fluorite'|'sapphire'|'diamond'|'water' glass ('N-BK7', 'N-BK10', 'N-K5', 'N-FK5', 'N-FK51A', 'N-BAK4', 'N-SK16', 'N-BAF10', 'N-LASF9', 'F2', 'N-F2', 'N-SF5', 'N-SF10', 'N-SF11', 'SF11', 'SF10', 'N-SF6', 'N-SF66', 'silica', 'fluorite', 'sapphire', 'diamond', 'water'; default none): A glass by its name: its index and its dispersion.
---@field glossy_samples? integer glossy_samples (a whole number, 1 to 64; default 4): At most N x N rays from a rough surface under Whitted, as many as its share of reflected light justifies.
---@field classic? boolean classic (true or false; default false): Whether Whitted's integrator shades it as a similar gr.material, which is faster.

---A layered surface of metal, glass, glossy diffuse, clear coat and fuzz: OpenPBR Surface 1.1.
---@param base_color? gr.triple|string|gr.texture|function base_color (a colour {r, g, b} or a texture, >= 0; default {0.8, 0.8, 0.8}): Diffuse colour; for metals the reflectance at normal incidence.
---@return gr.material
---@overload fun(fields: gr.openpbr_material.fields): gr.material
function gr.openpbr_material(base_color) end

---@class gr.metal_material.fields
---@field metal 'aluminium'|'brass'|'chromium'|'cobalt'|'copper'|'gold'|'iron'|'manganese'|'nickel'|'palladium'|'platinum'|'silver'|'titanium'|'tungsten'|'vanadium'|'zinc' metal ('aluminium', 'brass', 'chromium', 'cobalt', 'copper', 'gold', 'iron', 'manganese', 'nickel', 'palladium', 'platinum', 'silver', 'titanium', 'tungsten', 'vanadium', 'zinc'): Its name.
---@field roughness? number|gr.texture|function roughness (a number or a texture, 0 to 1; default 0): Roughness; 0 is polished.
---@field anisotropy? number|gr.texture|function anisotropy (a number or a texture, 0 to 1; default 0): How much smoother it is along the tangent than across.
---@field tangent? gr.triple tangent (a direction {x, y, z}; default along u): Direction along which the facets of an anisotropic surface are smooth, in the world.
---@field normal? string|gr.texture|function normal (the name of a picture file or a texture; default none): A normal map or bump map: a result of gr.bump, or the file of a normal map.
---@field glossy_samples? integer glossy_samples (a whole number, 1 to 64; default 4): At most N x N rays from a rough surface under Whitted, as many as its share of reflected light justifies.
---@field classic? boolean classic (true or false; default false): Whether Whitted's integrator shades it as a similar gr.material, which is faster.

---A metal with its measured reflectance.
---@param metal 'aluminium'|'brass'|'chromium'|'cobalt'|'copper'|'gold'|'iron'|'manganese'|'nickel'|'palladium'|'platinum'|'silver'|'titanium'|'tungsten'|'vanadium'|'zinc' metal ('aluminium', 'brass', 'chromium', 'cobalt', 'copper', 'gold', 'iron', 'manganese', 'nickel', 'palladium', 'platinum', 'silver', 'titanium', 'tungsten', 'vanadium', 'zinc'): Its name.
---@param roughness? number|gr.texture|function roughness (a number or a texture, 0 to 1; default 0): Roughness; 0 is polished.
---@return gr.material
---@overload fun(fields: gr.metal_material.fields): gr.material
function gr.metal_material(metal, roughness) end

---@class gr.mirror.fields
---@field colour? gr.triple|string|gr.texture|function colour (a colour {r, g, b} or a texture, >= 0; default {0.95, 0.95, 0.95}): Colour of the reflection.
---@field roughness? number|gr.texture|function roughness (a number or a texture, 0 to 1; default 0): Roughness; 0 is polished.

---A mirror.
---@param colour? gr.triple|string|gr.texture|function colour (a colour {r, g, b} or a texture, >= 0; default {0.95, 0.95, 0.95}): Colour of the reflection.
---@param roughness? number|gr.texture|function roughness (a number or a texture, 0 to 1; default 0): Roughness; 0 is polished.
---@return gr.material
---@overload fun(fields: gr.mirror.fields): gr.material
function gr.mirror(colour, roughness) end

---@class gr.glass.fields
---@field colour? gr.triple|string colour (a colour {r, g, b}, >= 0; default {1, 1, 1}): Colour of white light after depth.
---@field roughness? number|gr.texture|function roughness (a number or a texture, 0 to 1; default 0): Roughness; 0 is polished.
---@field ior? number ior (a number, 1 to 4; default 1.5): Index of refraction.
---@field depth? number depth (a number, > 0; default 1): Distance inside after which light has colour.
---@field thin? boolean thin (true or false; default false): Whether the surface is a pane: nothing is inside.
---@field glass? 'N-BK7'|'N-BK10'|'N-K5'|'N-FK5'|'N-FK51A'|'N-BAK4'|'N-SK16'|'N-BAF10'|'N-LASF9'|'F2'|'N-F2'|'N-SF5'|'N-SF10'|'N-SF11'|'SF11'|'SF10'|'N-SF6'|'N-SF66'|'silica'|'fluorite'|'sapphire'|'diamond'|'water' glass ('N-BK7', 'N-BK10', 'N-K5', 'N-FK5', 'N-FK51A', 'N-BAK4', 'N-SK16', 'N-BAF10', 'N-LASF9', 'F2', 'N-F2', 'N-SF5', 'N-SF10', 'N-SF11', 'SF11', 'SF10', 'N-SF6', 'N-SF66', 'silica', 'fluorite', 'sapphire', 'diamond', 'water'; default none): A glass by its name: its index and its dispersion.

---Clear, tinted or frosted glass.
---@param colour? gr.triple|string colour (a colour {r, g, b}, >= 0; default {1, 1, 1}): Colour of white light after depth.
---@param roughness? number|gr.texture|function roughness (a number or a texture, 0 to 1; default 0): Roughness; 0 is polished.
---@return gr.material
---@overload fun(fields: gr.glass.fields): gr.material
function gr.glass(colour, roughness) end

---@class gr.metal.fields
---@field metal? 'aluminium'|'brass'|'chromium'|'cobalt'|'copper'|'gold'|'iron'|'manganese'|'nickel'|'palladium'|'platinum'|'silver'|'titanium'|'tungsten'|'vanadium'|'zinc' metal ('aluminium', 'brass', 'chromium', 'cobalt', 'copper', 'gold', 'iron', 'manganese', 'nickel', 'palladium', 'platinum', 'silver', 'titanium', 'tungsten', 'vanadium', 'zinc'; default 'aluminium'): Its name.
---@field roughness? number|gr.texture|function roughness (a number or a texture, 0 to 1; default 0.15): Roughness; 0 is polished.
---@field colour? gr.triple|string|gr.texture|function colour (a colour {r, g, b} or a texture, >= 0; optional): Reflectance at normal incidence, instead of metal.
---@field brushed? number|gr.texture|function brushed (a number or a texture, 0 to 1; default 0): How much smoother it is along the texture coordinate u, as after brushing.

---A metal by its name or its colour.
---@param metal? 'aluminium'|'brass'|'chromium'|'cobalt'|'copper'|'gold'|'iron'|'manganese'|'nickel'|'palladium'|'platinum'|'silver'|'titanium'|'tungsten'|'vanadium'|'zinc' metal ('aluminium', 'brass', 'chromium', 'cobalt', 'copper', 'gold', 'iron', 'manganese', 'nickel', 'palladium', 'platinum', 'silver', 'titanium', 'tungsten', 'vanadium', 'zinc'; default 'aluminium'): Its name.
---@param roughness? number|gr.texture|function roughness (a number or a texture, 0 to 1; default 0.15): Roughness; 0 is polished.
---@return gr.material
---@overload fun(fields: gr.metal.fields): gr.material
function gr.metal(metal, roughness) end

---@class gr.plastic.fields
---@field colour? gr.triple|string|gr.texture|function colour (a colour {r, g, b} or a texture, >= 0; default {0.8, 0.8, 0.8}): Its colour.
---@field roughness? number|gr.texture|function roughness (a number or a texture, 0 to 1; default 0.15): Roughness; 0 is polished.

---Glossy or dull plastic.
---@param colour? gr.triple|string|gr.texture|function colour (a colour {r, g, b} or a texture, >= 0; default {0.8, 0.8, 0.8}): Its colour.
---@param roughness? number|gr.texture|function roughness (a number or a texture, 0 to 1; default 0.15): Roughness; 0 is polished.
---@return gr.material
---@overload fun(fields: gr.plastic.fields): gr.material
function gr.plastic(colour, roughness) end

---@class gr.paint.fields
---@field colour? gr.triple|string|gr.texture|function colour (a colour {r, g, b} or a texture, >= 0; default {0.8, 0.8, 0.8}): Its colour.
---@field finish? 'matt'|'satin'|'gloss'|'car' finish ('matt'|'satin'|'gloss'|'car'; default 'satin'): Its gloss; car: metal flakes below a clear coat.

---Paint, matt to glossy, or that of a car.
---@param colour? gr.triple|string|gr.texture|function colour (a colour {r, g, b} or a texture, >= 0; default {0.8, 0.8, 0.8}): Its colour.
---@param finish? 'matt'|'satin'|'gloss'|'car' finish ('matt'|'satin'|'gloss'|'car'; default 'satin'): Its gloss; car: metal flakes below a clear coat.
---@return gr.material
---@overload fun(fields: gr.paint.fields): gr.material
function gr.paint(colour, finish) end

---@class gr.cloth.fields
---@field colour? gr.triple|string|gr.texture|function colour (a colour {r, g, b} or a texture, >= 0; default {0.8, 0.8, 0.8}): Its colour.
---@field weave? 'cotton'|'velvet'|'silk' weave ('cotton'|'velvet'|'silk'; default 'cotton'): The kind of cloth.

---Cotton, velvet or silk.
---@param colour? gr.triple|string|gr.texture|function colour (a colour {r, g, b} or a texture, >= 0; default {0.8, 0.8, 0.8}): Its colour.
---@param weave? 'cotton'|'velvet'|'silk' weave ('cotton'|'velvet'|'silk'; default 'cotton'): The kind of cloth.
---@return gr.material
---@overload fun(fields: gr.cloth.fields): gr.material
function gr.cloth(colour, weave) end

---@class gr.studio.fields: gr.render.fields
---@field node gr.node node (a node): What the picture shows; it stands on the floor.
---@field sweep? boolean sweep (true or false; default true): Whether there is a floor that bends up into a wall.
---@field floor? gr.triple|string|gr.texture|function floor (a colour {r, g, b} or a texture, >= 0; default {0.6, 0.6, 0.6}): Colour of floor and wall.
---@field intensity? number intensity (a number, >= 0; default 1): Factor of all light.
---@field key? number key (a number, >= 0; default 1): Factor of the large light from the left above.
---@field fill? number fill (a number, >= 0; default 1): Factor of the light from the right.
---@field rim? number rim (a number, >= 0; default 1): Factor of the light from behind.
---@field turn? number turn (a number, in degrees; default 0): Rotation of the lights about the vertical, to the right.

---The fields for gr.render of a picture in a studio: a sweep, three area lights, and a camera that fits; all other fields of gr.render are added.
---@param node gr.node node (a node): What the picture shows; it stands on the floor.
---@return gr.render.fields
---@overload fun(fields: gr.studio.fields): gr.render.fields
function gr.studio(node) end

---@class gr.daylight.fields: gr.render.fields
---@field sun? gr.triple|{azimuth: number, elevation: number} sun (a direction {x, y, z} or {azimuth = ..., elevation = ...}; default {azimuth = 140, elevation = 40}): Direction to the sun: azimuth from north over east, elevation above the horizon; -z is north.
---@field place? string|number[] place (a string or two numbers; optional): Instead of sun: a city, or {latitude, longitude} in degrees, north and east positive.
---@field time? number|number[] time (a number or a table of numbers; default {2025, 6, 21, 15, 0}): With place: {year, month, day, hour, minute} of the clock there.
---@field zone? number zone (a number, >= -14 and <= 14, in hours; default that of place, without summer time): Difference of that clock to Greenwich; positive is east.
---@field turbidity? number turbidity (a number, 1.7 to 10; default 2.5): Turbidity of the air: 2 is very clear, 10 is hazy.
---@field ground? gr.triple|string ground (a colour {r, g, b}; default {0.15, 0.15, 0.15}): Colour below the horizon.
---@field intensity? number intensity (a number, >= 0; default 1): Factor of all light; with the default exposure it has no effect.

---The fields for gr.render of a picture in daylight: the sun with its disc, the clear sky, and exposure; all other fields of gr.render are added.
---@param sun? gr.triple|{azimuth: number, elevation: number} sun (a direction {x, y, z} or {azimuth = ..., elevation = ...}; default {azimuth = 140, elevation = 40}): Direction to the sun: azimuth from north over east, elevation above the horizon; -z is north.
---@return gr.render.fields
---@overload fun(fields: gr.daylight.fields): gr.render.fields
function gr.daylight(sun) end

---@class gr.light.fields
---@field colour gr.triple|string|gr.texture|function colour (a colour {r, g, b}): Colour and strength, or a function of the unit direction in which light leaves.
---@field include? gr.node[] include (a table of nodes; default all): Nodes that it lights, with their children.
---@field exclude? gr.node[] exclude (a table of nodes; default none): Nodes that it does not light, with their children.
---@field falloff? gr.triple falloff (a table of 3 numbers; default {1, 0, 0}): Coefficients c0, c1, c2: the falloff is 1 / (c0 + c1 d + c2 d^2).
---@field range? number range (a number, > 0; optional): Range, instead of falloff: the light is multiplied by 1 - d / range, and is 0 beyond.
---@field intensity? number intensity (a number, >= 0; optional): Inverse square falloff, instead of falloff: the light is multiplied by intensity / d^2.
---@field position gr.triple position (a point {x, y, z}): Position.

---A point light.
---@param position gr.triple position (a point {x, y, z}): Position.
---@param colour gr.triple|string|gr.texture|function colour (a colour {r, g, b}): Colour and strength, or a function of the unit direction in which light leaves.
---@param falloff? gr.triple falloff (a table of 3 numbers; default {1, 0, 0}): Coefficients c0, c1, c2: the falloff is 1 / (c0 + c1 d + c2 d^2).
---@return gr.light
---@overload fun(fields: gr.light.fields): gr.light
function gr.light(position, colour, falloff) end

---@class gr.area_light.fields
---@field colour? gr.triple|string|gr.texture|function colour (a colour {r, g, b}; default {1, 1, 1} with emission): Colour and strength, or a function of the unit direction in which light leaves.
---@field include? gr.node[] include (a table of nodes; default all): Nodes that it lights, with their children.
---@field exclude? gr.node[] exclude (a table of nodes; default none): Nodes that it does not light, with their children.
---@field falloff? gr.triple falloff (a table of 3 numbers; default {1, 0, 0}): Coefficients c0, c1, c2: the falloff is 1 / (c0 + c1 d + c2 d^2).
---@field range? number range (a number, > 0; optional): Range, instead of falloff: the light is multiplied by 1 - d / range, and is 0 beyond.
---@field intensity? number intensity (a number, >= 0; optional): Inverse square falloff, instead of falloff: the light is multiplied by intensity / d^2.
---@field emission? gr.triple|string emission (a colour {r, g, b}; optional): Radiance of its surface, multiplied by colour; the light then depends on its true shape, without falloff.
---@field samples? integer samples (a whole number, 1 to 64; default area_samples): N x N shadow rays for this light.
---@field visible? boolean visible (true or false; default false): Whether the light itself is visible.
---@field corner gr.triple corner (a point {x, y, z}): One corner of the parallelogram.
---@field v1 gr.triple v1 (a direction {x, y, z}): Edge from that corner.
---@field v2 gr.triple v2 (a direction {x, y, z}): The other edge from that corner.
---@field one_sided? boolean one_sided (true or false; default false): Whether it emits, and is visible, only on the side of v1 x v2.

---A parallelogram as a light, with soft shadows.
---@param corner gr.triple corner (a point {x, y, z}): One corner of the parallelogram.
---@param v1 gr.triple v1 (a direction {x, y, z}): Edge from that corner.
---@param v2 gr.triple v2 (a direction {x, y, z}): The other edge from that corner.
---@param colour gr.triple|string|gr.texture|function colour (a colour {r, g, b}; default {1, 1, 1} with emission): Colour and strength, or a function of the unit direction in which light leaves.
---@param falloff? gr.triple falloff (a table of 3 numbers; default {1, 0, 0}): Coefficients c0, c1, c2: the falloff is 1 / (c0 + c1 d + c2 d^2).
---@return gr.light
---@overload fun(fields: gr.area_light.fields): gr.light
function gr.area_light(corner, v1, v2, colour, falloff) end

---@class gr.spherical_light.fields
---@field colour? gr.triple|string|gr.texture|function colour (a colour {r, g, b}; default {1, 1, 1} with emission): Colour and strength, or a function of the unit direction in which light leaves.
---@field include? gr.node[] include (a table of nodes; default all): Nodes that it lights, with their children.
---@field exclude? gr.node[] exclude (a table of nodes; default none): Nodes that it does not light, with their children.
---@field falloff? gr.triple falloff (a table of 3 numbers; default {1, 0, 0}): Coefficients c0, c1, c2: the falloff is 1 / (c0 + c1 d + c2 d^2).
---@field range? number range (a number, > 0; optional): Range, instead of falloff: the light is multiplied by 1 - d / range, and is 0 beyond.
---@field intensity? number intensity (a number, >= 0; optional): Inverse square falloff, instead of falloff: the light is multiplied by intensity / d^2.
---@field emission? gr.triple|string emission (a colour {r, g, b}; optional): Radiance of its surface, multiplied by colour; the light then depends on its true shape, without falloff.
---@field samples? integer samples (a whole number, 1 to 64; default area_samples): N x N shadow rays for this light.
---@field visible? boolean visible (true or false; default false): Whether the light itself is visible.
---@field position gr.triple position (a point {x, y, z}): Its centre.
---@field radius number radius (a number, > 0): Its radius.

---A sphere as a light, with soft shadows.
---@param position gr.triple position (a point {x, y, z}): Its centre.
---@param colour gr.triple|string|gr.texture|function colour (a colour {r, g, b}; default {1, 1, 1} with emission): Colour and strength, or a function of the unit direction in which light leaves.
---@param falloff gr.triple falloff (a table of 3 numbers; default {1, 0, 0}): Coefficients c0, c1, c2: the falloff is 1 / (c0 + c1 d + c2 d^2).
---@param radius number radius (a number, > 0): Its radius.
---@return gr.light
---@overload fun(fields: gr.spherical_light.fields): gr.light
function gr.spherical_light(position, colour, falloff, radius) end

---@class gr.disc_light.fields
---@field colour? gr.triple|string|gr.texture|function colour (a colour {r, g, b}; default {1, 1, 1} with emission): Colour and strength, or a function of the unit direction in which light leaves.
---@field include? gr.node[] include (a table of nodes; default all): Nodes that it lights, with their children.
---@field exclude? gr.node[] exclude (a table of nodes; default none): Nodes that it does not light, with their children.
---@field falloff? gr.triple falloff (a table of 3 numbers; default {1, 0, 0}): Coefficients c0, c1, c2: the falloff is 1 / (c0 + c1 d + c2 d^2).
---@field range? number range (a number, > 0; optional): Range, instead of falloff: the light is multiplied by 1 - d / range, and is 0 beyond.
---@field intensity? number intensity (a number, >= 0; optional): Inverse square falloff, instead of falloff: the light is multiplied by intensity / d^2.
---@field emission? gr.triple|string emission (a colour {r, g, b}; optional): Radiance of its surface, multiplied by colour; the light then depends on its true shape, without falloff.
---@field samples? integer samples (a whole number, 1 to 64; default area_samples): N x N shadow rays for this light.
---@field visible? boolean visible (true or false; default false): Whether the light itself is visible.
---@field position gr.triple position (a point {x, y, z}): Its centre.
---@field normal gr.triple normal (a direction {x, y, z}): The direction it faces.
---@field radius number radius (a number, > 0): Its radius.
---@field one_sided? boolean one_sided (true or false; default false): Whether it emits, and is visible, only on the side of its normal.

---A disc as a light, with soft shadows.
---@param position gr.triple position (a point {x, y, z}): Its centre.
---@param normal gr.triple normal (a direction {x, y, z}): The direction it faces.
---@param radius number radius (a number, > 0): Its radius.
---@param colour gr.triple|string|gr.texture|function colour (a colour {r, g, b}; default {1, 1, 1} with emission): Colour and strength, or a function of the unit direction in which light leaves.
---@param falloff? gr.triple falloff (a table of 3 numbers; default {1, 0, 0}): Coefficients c0, c1, c2: the falloff is 1 / (c0 + c1 d + c2 d^2).
---@return gr.light
---@overload fun(fields: gr.disc_light.fields): gr.light
function gr.disc_light(position, normal, radius, colour, falloff) end

---@class gr.directional_light.fields
---@field colour gr.triple|string colour (a colour {r, g, b}): Colour and strength.
---@field include? gr.node[] include (a table of nodes; default all): Nodes that it lights, with their children.
---@field exclude? gr.node[] exclude (a table of nodes; default none): Nodes that it does not light, with their children.
---@field direction gr.triple direction (a direction {x, y, z}): Direction in which the light travels.

---A light at infinity: all its rays are parallel.
---@param direction gr.triple direction (a direction {x, y, z}): Direction in which the light travels.
---@param colour gr.triple|string colour (a colour {r, g, b}): Colour and strength.
---@return gr.light
---@overload fun(fields: gr.directional_light.fields): gr.light
function gr.directional_light(direction, colour) end

---@class gr.spot_light.fields
---@field colour gr.triple|string|gr.texture|function colour (a colour {r, g, b}): Colour and strength, or a function of the unit direction in which light leaves.
---@field include? gr.node[] include (a table of nodes; default all): Nodes that it lights, with their children.
---@field exclude? gr.node[] exclude (a table of nodes; default none): Nodes that it does not light, with their children.
---@field falloff? gr.triple falloff (a table of 3 numbers; default {1, 0, 0}): Coefficients c0, c1, c2: the falloff is 1 / (c0 + c1 d + c2 d^2).
---@field range? number range (a number, > 0; optional): Range, instead of falloff: the light is multiplied by 1 - d / range, and is 0 beyond.
---@field intensity? number intensity (a number, >= 0; optional): Inverse square falloff, instead of falloff: the light is multiplied by intensity / d^2.
---@field position gr.triple position (a point {x, y, z}): Position.
---@field direction? gr.triple direction (a direction {x, y, z}; default {0, -1, 0}): The axis of its cone.
---@field target? gr.triple target (a point {x, y, z}; optional): A point on the axis, instead of direction.
---@field inner? number inner (a number, 0 to 180, in degrees; default three quarters of outer): Angle from the axis where the light begins to fall off.
---@field outer? number outer (a number, > 0 and <= 180, in degrees; default 30, or inner if that is more): Angle from the axis where the light ends.

---A point light that shines into a cone.
---@param position gr.triple position (a point {x, y, z}): Position.
---@param direction gr.triple direction (a direction {x, y, z}; default {0, -1, 0}): The axis of its cone.
---@param colour gr.triple|string|gr.texture|function colour (a colour {r, g, b}): Colour and strength, or a function of the unit direction in which light leaves.
---@param inner number inner (a number, 0 to 180, in degrees; default three quarters of outer): Angle from the axis where the light begins to fall off.
---@param outer number outer (a number, > 0 and <= 180, in degrees; default 30, or inner if that is more): Angle from the axis where the light ends.
---@param falloff? gr.triple falloff (a table of 3 numbers; default {1, 0, 0}): Coefficients c0, c1, c2: the falloff is 1 / (c0 + c1 d + c2 d^2).
---@return gr.light
---@overload fun(fields: gr.spot_light.fields): gr.light
function gr.spot_light(position, direction, colour, inner, outer, falloff) end

---@class gr.mesh_light.fields
---@field colour? gr.triple|string colour (a colour {r, g, b}; default {1, 1, 1} with emission): Colour and strength.
---@field include? gr.node[] include (a table of nodes; default all): Nodes that it lights, with their children.
---@field exclude? gr.node[] exclude (a table of nodes; default none): Nodes that it does not light, with their children.
---@field emission? gr.triple|string emission (a colour {r, g, b}; default its materials'): Radiance of its surface, multiplied by colour.
---@field samples? integer samples (a whole number, 1 to 64; default area_samples): N x N shadow rays for this light.
---@field mesh gr.node mesh (a node): A mesh, or a node with meshes below it. It emits at each of its positions in the scene; if it is not in the scene, it emits invisibly at its own transforms.

---The triangles of a mesh as a light.
---@param mesh gr.node mesh (a node): A mesh, or a node with meshes below it. It emits at each of its positions in the scene; if it is not in the scene, it emits invisibly at its own transforms.
---@param emission? gr.triple|string emission (a colour {r, g, b}; default its materials'): Radiance of its surface, multiplied by colour.
---@return gr.light
---@overload fun(fields: gr.mesh_light.fields): gr.light
function gr.mesh_light(mesh, emission) end

---@class gr.sky_light.fields
---@field colour? gr.triple|string colour (a colour {r, g, b}; default {1, 1, 1} with emission): Colour and strength.
---@field include? gr.node[] include (a table of nodes; default all): Nodes that it lights, with their children.
---@field exclude? gr.node[] exclude (a table of nodes; default none): Nodes that it does not light, with their children.
---@field sky gr.triple|string|gr.sky|gr.texture|function|'gradient' sky (a colour {r, g, b}, a sky, a function or 'gradient'): A sky, a colour, a function of the unit direction, or 'gradient'.
---@field samples? integer samples (a whole number, 1 to 64; default area_samples): N x N shadow rays for this light.

---A sky as a light; bright parts get more shadow rays.
---@param sky gr.triple|string|gr.sky|gr.texture|function|'gradient' sky (a colour {r, g, b}, a sky, a function or 'gradient'): A sky, a colour, a function of the unit direction, or 'gradient'.
---@return gr.light
---@overload fun(fields: gr.sky_light.fields): gr.light
function gr.sky_light(sky) end

---@class gr.change_node.fields
---@field name string name (a string): Name of the node; gray ignores a node with another name.
---@field serial integer serial (a whole number, 0 to 4294967295): Its number in order of creation, from 0; nodes added in the window count down from 4294967295.
---@field matrix number|number[] matrix (a number or a table of numbers): Three rows of a matrix, 12 numbers, applied after its own transforms, in the space of its parent.

---Transforms a node in all later pictures. The window saves edits as a file of such calls; require loads it.
---@param name string name (a string): Name of the node; gray ignores a node with another name.
---@param serial integer serial (a whole number, 0 to 4294967295): Its number in order of creation, from 0; nodes added in the window count down from 4294967295.
---@param matrix number|number[] matrix (a number or a table of numbers): Three rows of a matrix, 12 numbers, applied after its own transforms, in the space of its parent.
---@overload fun(fields: gr.change_node.fields)
function gr.change_node(name, serial, matrix) end

---@class gr.change_delete.fields
---@field name string name (a string): Name of the node; gray ignores a node with another name.
---@field serial integer serial (a whole number, 0 to 4294967295): Its number in order of creation, from 0; nodes added in the window count down from 4294967295.

---Removes a node and its children from all later pictures.
---@param name string name (a string): Name of the node; gray ignores a node with another name.
---@param serial integer serial (a whole number, 0 to 4294967295): Its number in order of creation, from 0; nodes added in the window count down from 4294967295.
---@overload fun(fields: gr.change_delete.fields)
function gr.change_delete(name, serial) end

---@class gr.change_add.fields
---@field name string name (a string): Name of the parent node.
---@field serial integer serial (a whole number, 0 to 4294967295): Its number in order of creation, from 0; nodes added in the window count down from 4294967295.
---@field shape string shape (a string): The call that makes the new node, such as 'gr.torus{minor = 0.1}', or 'copy'.
---@field colour? gr.triple|string colour (a colour {r, g, b}; default {0.7, 0.7, 0.7}): Colour of a shape whose call gives it no material.
---@field source? integer source (a whole number, 0 to 4294967295; default 0): For a copy: the number of the node to copy.

---Adds a node to all later pictures; gr.change_node places it.
---@param name string name (a string): Name of the parent node.
---@param serial integer serial (a whole number, 0 to 4294967295): Its number in order of creation, from 0; nodes added in the window count down from 4294967295.
---@param shape string shape (a string): The call that makes the new node, such as 'gr.torus{minor = 0.1}', or 'copy'.
---@param colour? gr.triple|string colour (a colour {r, g, b}; default {0.7, 0.7, 0.7}): Colour of a shape whose call gives it no material.
---@param source? integer source (a whole number, 0 to 4294967295; default 0): For a copy: the number of the node to copy.
---@overload fun(fields: gr.change_add.fields)
function gr.change_add(name, serial, shape, colour, source) end

---@class gr.change_material.fields
---@field serial integer serial (a whole number, 0 to 4294967295): Number of the material in order of creation, from 1.
---@field colour gr.triple|string colour (a colour {r, g, b}): New kd of its base material.

---Changes the colour of a material in all later pictures.
---@param serial integer serial (a whole number, 0 to 4294967295): Number of the material in order of creation, from 1.
---@param colour gr.triple|string colour (a colour {r, g, b}): New kd of its base material.
---@overload fun(fields: gr.change_material.fields)
function gr.change_material(serial, colour) end

---@class gr.change_look.fields
---@field serial integer serial (a whole number, 0 to 4294967295): Number of the material in order of creation, from 1.
---@field part 'kd'|'ks'|'shininess'|'reflect'|'roughness'|'refract'|'ior'|'emission'|'absorption' part ('kd', 'ks', 'shininess', 'reflect', 'roughness', 'refract', 'ior', 'emission', 'absorption'): Argument of gr.material to change in its base material.
---@field value number|number[] value (a number or a table of numbers): New value: three numbers for a colour, else one.

---Changes an input of a base material in all later pictures.
---@param serial integer serial (a whole number, 0 to 4294967295): Number of the material in order of creation, from 1.
---@param part 'kd'|'ks'|'shininess'|'reflect'|'roughness'|'refract'|'ior'|'emission'|'absorption' part ('kd', 'ks', 'shininess', 'reflect', 'roughness', 'refract', 'ior', 'emission', 'absorption'): Argument of gr.material to change in its base material.
---@param value number|number[] value (a number or a table of numbers): New value: three numbers for a colour, else one.
---@overload fun(fields: gr.change_look.fields)
function gr.change_look(serial, part, value) end

---@class gr.change_texture.fields
---@field serial integer serial (a whole number, 0 to 4294967295): Number of the material in order of creation, from 1.
---@field call string call (a string): The call that makes the texture, such as 'gr.texture("wood.png")'.

---Makes a texture the kd of a base material in all later pictures.
---@param serial integer serial (a whole number, 0 to 4294967295): Number of the material in order of creation, from 1.
---@param call string call (a string): The call that makes the texture, such as 'gr.texture("wood.png")'.
---@overload fun(fields: gr.change_texture.fields)
function gr.change_texture(serial, call) end

---@class gr.change_own.fields
---@field name string name (a string): Name of the node; gray ignores a node with another name.
---@field serial integer serial (a whole number, 0 to 4294967295): Its number in order of creation, from 0; nodes added in the window count down from 4294967295.
---@field like? integer like (a whole number, 0 to 4294967295; default 0): For a shape without a material: number of the material to copy; 0: plain gray.

---Gives a shape its own copy of its material in all later pictures. The copies are numbered 2147483647, 2147483646 and so on.
---@param name string name (a string): Name of the node; gray ignores a node with another name.
---@param serial integer serial (a whole number, 0 to 4294967295): Its number in order of creation, from 0; nodes added in the window count down from 4294967295.
---@param like? integer like (a whole number, 0 to 4294967295; default 0): For a shape without a material: number of the material to copy; 0: plain gray.
---@overload fun(fields: gr.change_own.fields)
function gr.change_own(name, serial, like) end

---@class gr.change_light.fields
---@field number integer number (a whole number, 1 to 4294967295): Index in the list of lights of gr.render, from 1.
---@field move gr.triple move (a table of 3 numbers): Translation.
---@field factor? gr.triple factor (a table of 3 numbers; default {1, 1, 1}): Factor of its colour.
---@field linear? number|number[] linear (a number or a table of numbers; default none): Three rows of a matrix, 9 numbers: rotation and scale about its position.
---@field colour? gr.triple|string colour (a colour {r, g, b}; default its own): New colour, before the factor.

---Moves, rotates, scales or recolours a light in all later pictures.
---@param number integer number (a whole number, 1 to 4294967295): Index in the list of lights of gr.render, from 1.
---@param move gr.triple move (a table of 3 numbers): Translation.
---@param factor? gr.triple factor (a table of 3 numbers; default {1, 1, 1}): Factor of its colour.
---@param linear? number|number[] linear (a number or a table of numbers; default none): Three rows of a matrix, 9 numbers: rotation and scale about its position.
---@param colour? gr.triple|string colour (a colour {r, g, b}; default its own): New colour, before the factor.
---@overload fun(fields: gr.change_light.fields)
function gr.change_light(number, move, factor, linear, colour) end

---@class gr.change_delete_light.fields
---@field number integer number (a whole number, 1 to 4294967295): Index in the list of lights of gr.render, from 1.

---Removes a light from all later pictures.
---@param number integer number (a whole number, 1 to 4294967295): Index in the list of lights of gr.render, from 1.
---@overload fun(fields: gr.change_delete_light.fields)
function gr.change_delete_light(number) end

---@class gr.change_add_light.fields
---@field position gr.triple position (a point {x, y, z}): Translation of the light.
---@field colour gr.triple|string colour (a colour {r, g, b}): Factor of its colour.
---@field call? string call (a string; default a white point light at the origin): The call that makes it, such as 'gr.spot_light{...}'.

---Adds a light to all later pictures.
---@param position gr.triple position (a point {x, y, z}): Translation of the light.
---@param colour gr.triple|string colour (a colour {r, g, b}): Factor of its colour.
---@param call? string call (a string; default a white point light at the origin): The call that makes it, such as 'gr.spot_light{...}'.
---@overload fun(fields: gr.change_add_light.fields)
function gr.change_add_light(position, colour, call) end

---@class gr.change_copy_light.fields
---@field number integer number (a whole number, 1 to 4294967295): Index in the list of lights of gr.render, from 1.
---@field move gr.triple move (a table of 3 numbers): Translation of the copy.
---@field factor? gr.triple factor (a table of 3 numbers; default {1, 1, 1}): Factor of the colour of the copy.

---Adds a copy of a light to all later pictures.
---@param number integer number (a whole number, 1 to 4294967295): Index in the list of lights of gr.render, from 1.
---@param move gr.triple move (a table of 3 numbers): Translation of the copy.
---@param factor? gr.triple factor (a table of 3 numbers; default {1, 1, 1}): Factor of the colour of the copy.
---@overload fun(fields: gr.change_copy_light.fields)
function gr.change_copy_light(number, move, factor) end

---@class gr.change_view.fields
---@field picture string picture (a string): The file name that gr.render has for the picture.
---@field eye gr.triple eye (a point {x, y, z}): Position of the camera.
---@field view gr.triple view (a direction {x, y, z}): Direction of view.
---@field up gr.triple up (a direction {x, y, z}): Direction that is up in the picture.
---@field fov number fov (a number, > 0 and < 180, in degrees): Full vertical angle of view.

---Changes the camera of a picture.
---@param picture string picture (a string): The file name that gr.render has for the picture.
---@param eye gr.triple eye (a point {x, y, z}): Position of the camera.
---@param view gr.triple view (a direction {x, y, z}): Direction of view.
---@param up gr.triple up (a direction {x, y, z}): Direction that is up in the picture.
---@param fov number fov (a number, > 0 and < 180, in degrees): Full vertical angle of view.
---@overload fun(fields: gr.change_view.fields)
function gr.change_view(picture, eye, view, up, fov) end

---@class gr.change_exposure.fields
---@field picture string picture (a string): The file name that gr.render has for the picture.
---@field stops number stops (a number, >= -100 and <= 100, in stops): New exposure.

---Changes the exposure of a picture.
---@param picture string picture (a string): The file name that gr.render has for the picture.
---@param stops number stops (a number, >= -100 and <= 100, in stops): New exposure.
---@overload fun(fields: gr.change_exposure.fields)
function gr.change_exposure(picture, stops) end

---@class gr.sun_light.fields
---@field colour gr.triple|string colour (a colour {r, g, b}): Colour and strength.
---@field include? gr.node[] include (a table of nodes; default all): Nodes that it lights, with their children.
---@field exclude? gr.node[] exclude (a table of nodes; default none): Nodes that it does not light, with their children.
---@field sun? gr.triple sun (a direction {x, y, z}; optional): Direction to the sun, instead of time and position.
---@field hour? number hour (a number, 0 to 24; default 12): Local time of day.
---@field day? integer day (a whole number, 1 to 366; default 172, 21 June): Day of the year.
---@field latitude? number latitude (a number, >= -90 and <= 90, in degrees; default 45): Positive is north; in the scene, -z is north and +x is east.
---@field longitude? number longitude (a number, >= -180 and <= 180, in degrees; default 0): Positive is east.
---@field zone? number zone (a number, >= -14 and <= 14, in hours; default 0): Difference of the local time to Greenwich; positive is east.
---@field year? integer year (a whole number, 1901 to 2099; default 2025): Year of the day.

---A directional light from the position of the sun.
---@param sun gr.triple sun (a direction {x, y, z}; optional): Direction to the sun, instead of time and position.
---@param colour gr.triple|string colour (a colour {r, g, b}): Colour and strength.
---@return gr.light
---@overload fun(fields: gr.sun_light.fields): gr.light
function gr.sun_light(sun, colour) end

---@class gr.sky_faces.fields
---@field intensity? number intensity (a number, >= 0; default 1): Factor of its brightness.
---@field rotation? number rotation (a number, in degrees; default 0): Rotation about y, counterclockwise seen from above.
---@field front string|gr.texture front (the name of a picture file or a texture): A square picture, as seen from the centre.
---@field right string|gr.texture right (the name of a picture file or a texture): A square picture, as seen from the centre.
---@field back string|gr.texture back (the name of a picture file or a texture): A square picture, as seen from the centre.
---@field left string|gr.texture left (the name of a picture file or a texture): A square picture, as seen from the centre.
---@field top string|gr.texture top (the name of a picture file or a texture): A square picture, as seen from the centre.
---@field bottom string|gr.texture bottom (the name of a picture file or a texture): A square picture, as seen from the centre.

---A sky of six pictures on a cube: front is +z, right is -x, back is -z, left is +x.
---@param front string|gr.texture front (the name of a picture file or a texture): A square picture, as seen from the centre.
---@param right string|gr.texture right (the name of a picture file or a texture): A square picture, as seen from the centre.
---@param back string|gr.texture back (the name of a picture file or a texture): A square picture, as seen from the centre.
---@param left string|gr.texture left (the name of a picture file or a texture): A square picture, as seen from the centre.
---@param top string|gr.texture top (the name of a picture file or a texture): A square picture, as seen from the centre.
---@param bottom string|gr.texture bottom (the name of a picture file or a texture): A square picture, as seen from the centre.
---@return gr.sky
---@overload fun(fields: gr.sky_faces.fields): gr.sky
function gr.sky_faces(front, right, back, left, top, bottom) end

---@class gr.sky_cross.fields
---@field intensity? number intensity (a number, >= 0; default 1): Factor of its brightness.
---@field rotation? number rotation (a number, in degrees; default 0): Rotation about y, counterclockwise seen from above.
---@field image string|gr.texture image (the name of a picture file or a texture): A picture file with six views in a 4 x 3 cross.
---@field mirror? boolean mirror (true or false; default false): Whether the cross is mirrored.

---A sky from a 4 x 3 cross of images.
---@param image string|gr.texture image (the name of a picture file or a texture): A picture file with six views in a 4 x 3 cross.
---@return gr.sky
---@overload fun(fields: gr.sky_cross.fields): gr.sky
function gr.sky_cross(image) end

---@class gr.sky_map.fields
---@field intensity? number intensity (a number, >= 0; default 1): Factor of its brightness.
---@field rotation? number rotation (a number, in degrees; default 0): Rotation about y, counterclockwise seen from above.
---@field image string|gr.texture image (the name of a picture file or a texture): Picture of the whole sphere, longitude by latitude, with -z in the middle and +x to the right. Radiance HDR, PFM and EXR files hold values above 1.

---A sky from one picture of the whole sphere.
---@param image string|gr.texture image (the name of a picture file or a texture): Picture of the whole sphere, longitude by latitude, with -z in the middle and +x to the right. Radiance HDR, PFM and EXR files hold values above 1.
---@return gr.sky
---@overload fun(fields: gr.sky_map.fields): gr.sky
function gr.sky_map(image) end

---@class gr.sky_gradient.fields
---@field intensity? number intensity (a number, >= 0; default 1): Factor of its brightness.
---@field rotation? number rotation (a number, in degrees; default 0): Rotation about y, counterclockwise seen from above.
---@field stops number[][] stops (a table of stops {height, r, g, b}): Colours by height, {y, r, g, b}; y of the unit direction, from -1 to 1; linear between.

---A sky with colours by height.
---@param stops number[][] stops (a table of stops {height, r, g, b}): Colours by height, {y, r, g, b}; y of the unit direction, from -1 to 1; linear between.
---@return gr.sky
---@overload fun(fields: gr.sky_gradient.fields): gr.sky
function gr.sky_gradient(stops) end

---@class gr.sky_function.fields
---@field intensity? number intensity (a number, >= 0; default 1): Factor of its brightness.
---@field rotation? number rotation (a number, in degrees; default 0): Rotation about y, counterclockwise seen from above.
---@field f function|gr.texture f (a function): A function of the unit direction; it returns a colour or a number.

---A sky whose colour is a function of the direction.
---@param f function|gr.texture f (a function): A function of the unit direction; it returns a colour or a number.
---@return gr.sky
---@overload fun(fields: gr.sky_function.fields): gr.sky
function gr.sky_function(f) end

---@class gr.clear_sky.fields
---@field intensity? number intensity (a number, >= 0; default 1): Factor of its brightness.
---@field rotation? number rotation (a number, in degrees; default 0): Rotation about y, counterclockwise seen from above.
---@field sun? gr.triple sun (a direction {x, y, z}; optional): Direction to the sun, instead of time and position.
---@field hour? number hour (a number, 0 to 24; default 12): Local time of day.
---@field day? integer day (a whole number, 1 to 366; default 172, 21 June): Day of the year.
---@field latitude? number latitude (a number, >= -90 and <= 90, in degrees; default 45): Positive is north; in the scene, -z is north and +x is east.
---@field longitude? number longitude (a number, >= -180 and <= 180, in degrees; default 0): Positive is east.
---@field zone? number zone (a number, >= -14 and <= 14, in hours; default 0): Difference of the local time to Greenwich; positive is east.
---@field year? integer year (a whole number, 1901 to 2099; default 2025): Year of the day.
---@field turbidity? number turbidity (a number, 1.7 to 10; default 2.5): Turbidity of the air: 2 is very clear, 10 is hazy.
---@field ground? gr.triple|string ground (a colour {r, g, b}; default {0.15, 0.15, 0.15}): Colour below the horizon.

---The clear sky model of Preetham, Shirley and Smits (1999).
---@param sun gr.triple sun (a direction {x, y, z}; optional): Direction to the sun, instead of time and position.
---@param turbidity? number turbidity (a number, 1.7 to 10; default 2.5): Turbidity of the air: 2 is very clear, 10 is hazy.
---@return gr.sky
---@overload fun(fields: gr.clear_sky.fields): gr.sky
function gr.clear_sky(sun, turbidity) end

---@class gr.uniform_fog.fields
---@field colour? gr.triple|string colour (a colour {r, g, b}; default {0.5, 0.5, 0.5}): Its colour.
---@field clear_sky? boolean clear_sky (true or false; default false): Whether the fog leaves the sky unchanged.
---@field density number density (a number, >= 0): Transmittance over distance d is exp(-density d).
---@field squared? boolean squared (true or false; default false): Transmittance is exp(-(density d)^2) instead.

---Fog of constant density.
---@param density number density (a number, >= 0): Transmittance over distance d is exp(-density d).
---@param colour? gr.triple|string colour (a colour {r, g, b}; default {0.5, 0.5, 0.5}): Its colour.
---@return gr.fog
---@overload fun(fields: gr.uniform_fog.fields): gr.fog
function gr.uniform_fog(density, colour) end

---@class gr.linear_fog.fields
---@field colour? gr.triple|string colour (a colour {r, g, b}; default {0.5, 0.5, 0.5}): Its colour.
---@field clear_sky? boolean clear_sky (true or false; default false): Whether the fog leaves the sky unchanged.
---@field near? number near (a number, >= 0; default 0): Distance where the fog begins.
---@field far number far (a number, > 0): Distance where the transmittance is 0.

---Fog whose transmittance falls linearly with distance.
---@param near number near (a number, >= 0; default 0): Distance where the fog begins.
---@param far number far (a number, > 0): Distance where the transmittance is 0.
---@param colour? gr.triple|string colour (a colour {r, g, b}; default {0.5, 0.5, 0.5}): Its colour.
---@return gr.fog
---@overload fun(fields: gr.linear_fog.fields): gr.fog
function gr.linear_fog(near, far, colour) end

---@class gr.height_fog.fields
---@field colour? gr.triple|string colour (a colour {r, g, b}; default {0.5, 0.5, 0.5}): Its colour.
---@field clear_sky? boolean clear_sky (true or false; default false): Whether the fog leaves the sky unchanged.
---@field density number density (a number, >= 0): Density at the base.
---@field base? number base (a number; default 0): Height y of the base.
---@field scale? number scale (a number, > 0; default 1): Height over which the density falls by the factor e.

---Fog whose density falls exponentially with height.
---@param density number density (a number, >= 0): Density at the base.
---@param base number base (a number; default 0): Height y of the base.
---@param scale number scale (a number, > 0; default 1): Height over which the density falls by the factor e.
---@param colour? gr.triple|string colour (a colour {r, g, b}; default {0.5, 0.5, 0.5}): Its colour.
---@return gr.fog
---@overload fun(fields: gr.height_fog.fields): gr.fog
function gr.height_fog(density, base, scale, colour) end

---@class gr.fog_profile.fields
---@field colour? gr.triple|string colour (a colour {r, g, b}; default {0.5, 0.5, 0.5}): Its colour.
---@field clear_sky? boolean clear_sky (true or false; default false): Whether the fog leaves the sky unchanged.
---@field profile number[][] profile (a table of pairs {u, v}): Densities by height, {y, density}; linear between the entries, constant beyond them.

---Fog with a density by height.
---@param profile number[][] profile (a table of pairs {u, v}): Densities by height, {y, density}; linear between the entries, constant beyond them.
---@param colour? gr.triple|string colour (a colour {r, g, b}; default {0.5, 0.5, 0.5}): Its colour.
---@return gr.fog
---@overload fun(fields: gr.fog_profile.fields): gr.fog
function gr.fog_profile(profile, colour) end

---@class gr.fog_grid.fields
---@field colour? gr.triple|string colour (a colour {r, g, b}; default {0.5, 0.5, 0.5}): Its colour.
---@field clear_sky? boolean clear_sky (true or false; default false): Whether the fog leaves the sky unchanged.
---@field corner gr.triple corner (a point {x, y, z}): The corner with the smallest coordinates.
---@field size number|gr.triple size (a number or a table of 3 numbers, > 0): Length of the edges, one number or three.
---@field cells gr.triple cells (a table of 3 numbers, 1 to 1024): Number of cells along x, y and z.
---@field densities number|number[] densities (a number or a table of numbers, >= 0): Density of each cell; x varies fastest, then y, then z.

---Fog in the cells of a box; no fog outside.
---@param corner gr.triple corner (a point {x, y, z}): The corner with the smallest coordinates.
---@param size number|gr.triple size (a number or a table of 3 numbers, > 0): Length of the edges, one number or three.
---@param cells gr.triple cells (a table of 3 numbers, 1 to 1024): Number of cells along x, y and z.
---@param densities number|number[] densities (a number or a table of numbers, >= 0): Density of each cell; x varies fastest, then y, then z.
---@param colour? gr.triple|string colour (a colour {r, g, b}; default {0.5, 0.5, 0.5}): Its colour.
---@return gr.fog
---@overload fun(fields: gr.fog_grid.fields): gr.fog
function gr.fog_grid(corner, size, cells, densities, colour) end

---@class gr.fog_field.fields
---@field colour? gr.triple|string|gr.texture|function colour (a colour {r, g, b}; default {0.5, 0.5, 0.5}): Its colour, or a function f(p, s) of the point, s.view and s.time.
---@field clear_sky? boolean clear_sky (true or false; default false): Whether the fog leaves the sky unchanged.
---@field corner gr.triple corner (a point {x, y, z}): The corner with the smallest coordinates.
---@field size number|gr.triple size (a number or a table of 3 numbers, > 0): Length of the edges, one number or three.
---@field density function|gr.texture density (a function): A function f(p, s) of the point and s.time; it returns a number of at least 0.

---Fog in a box whose density is a function of the point; no fog outside.
---@param corner gr.triple corner (a point {x, y, z}): The corner with the smallest coordinates.
---@param size number|gr.triple size (a number or a table of 3 numbers, > 0): Length of the edges, one number or three.
---@param density function|gr.texture density (a function): A function f(p, s) of the point and s.time; it returns a number of at least 0.
---@param colour? gr.triple|string|gr.texture|function colour (a colour {r, g, b}; default {0.5, 0.5, 0.5}): Its colour, or a function f(p, s) of the point, s.view and s.time.
---@return gr.fog
---@overload fun(fields: gr.fog_field.fields): gr.fog
function gr.fog_field(corner, size, density, colour) end

---@class gr.medium.fields
---@field absorption? gr.triple|string absorption (a colour {r, g, b}, >= 0; default {0, 0, 0}): Light absorbed, per unit of length.
---@field scattering? gr.triple|string scattering (a colour {r, g, b}, >= 0; default {0, 0, 0}): Light scattered, per unit of length.
---@field albedo? gr.triple|string albedo (a colour {r, g, b}, 0 to 1; default {1, 1, 1}): With distance, instead of absorption and scattering: the share that is scattered.
---@field distance? number distance (a number, > 0; default 1): The mean free path: what light travels between two events, on average.
---@field emission? gr.triple|string emission (a colour {r, g, b}, >= 0; default {0, 0, 0}): Light that the medium adds, per unit of length.
---@field temperature? number|number[]|string|gr.texture|function temperature (a number or a table of numbers, a function or the name of a file, >= 0, in kelvin; optional): The medium glows as a black body, with emission as a factor, {1, 1, 1} by default: a number, a function or a grid, as density.
---@field g? number g (a number, > -1 and < 1; default 0): Mean cosine of the deflection (Henyey and Greenstein): 0 in all directions alike, near 1 forward.
---@field phase? 'rayleigh' phase ('rayleigh'; optional): Rayleigh's phase function, of very small particles, instead of g.
---@field density? number|number[]|string|gr.texture|function density (a number or a table of numbers, a function or the name of a file, >= 0; default 1): The factor of absorption, scattering and emission: a number, a function f(p, s) of the point and s.time, or a grid: numbers, or the name of an NRRD file or of a file of plain values.
---@field bound? number bound (a number, > 0; default found by gray): A bound of a density function; where the function is larger, it counts as the bound.
---@field corner? gr.triple corner (a point {x, y, z}; optional): With size, the box of the medium or of its grid: the corner with the smallest coordinates.
---@field size? number|gr.triple size (a number or a table of 3 numbers, > 0; optional): Length of the edges of that box, one number or three.
---@field top? number top (a number; default none): The medium ends at this height y.
---@field cells? gr.triple cells (a table of 3 numbers, 1 to 4096; optional): Of a grid of numbers or plain values: how many there are along x, y and z; x varies fastest.
---@field type? 'float'|'double'|'uint8'|'int16'|'uint16' type ('float'|'double'|'uint8'|'int16'|'uint16'; default 'float'): Type of the values of a plain file, little-endian.

---A medium that absorbs, scatters and emits light.
---@param scattering gr.triple|string scattering (a colour {r, g, b}, >= 0; default {0, 0, 0}): Light scattered, per unit of length.
---@param absorption? gr.triple|string absorption (a colour {r, g, b}, >= 0; default {0, 0, 0}): Light absorbed, per unit of length.
---@return gr.medium
---@overload fun(fields: gr.medium.fields): gr.medium
function gr.medium(scattering, absorption) end

---@class gr.render.fields
---@field node gr.node node (a node): Root node of the picture.
---@field file? string file (the name of a file; default SCRIPT.png): Picture file: .png, for linear light .pfm .hdr .exr .lf; gray creates missing folders.
---@field sky? string|gr.texture|gr.sky sky (the name of a picture file or a texture or a sky; optional): Background that is also light: a sky, or a picture of the whole sphere, twice as wide as high. A picture with six views in a 4 x 3 cross is background only.
---@field width? integer width (a whole number, 1 to 1048576, in pixels; default 960): Width of the picture.
---@field height? integer height (a whole number, 1 to 1048576, in pixels; default 9/16 of width): Height of the picture.
---@field eye? gr.triple eye (a point {x, y, z}; default fits the scene): Position of the camera.
---@field view? gr.triple view (a direction {x, y, z}; default {0, 0, -1}): Direction of view.
---@field up? gr.triple up (a direction {x, y, z}; default {0, 1, 0}): Direction that is up in the picture.
---@field fov? number fov (a number, > 0 and < 180, in degrees; default 50): Full vertical angle of view.
---@field ambient? gr.triple|string ambient (a colour {r, g, b}; default {0, 0, 0}): Ambient light.
---@field lights? gr.light[] lights (a table of lights; default {}): The lights.
---@field target? gr.triple target (a point {x, y, z}; optional): Point to look at, instead of view.
---@field background? gr.triple|string|gr.sky|gr.texture|function|'gradient' background (a colour {r, g, b}, a sky, a function or 'gradient'; default 'gradient'): Background for rays that hit nothing: a colour, a sky, a function of the unit direction, 'gradient' for {0, 0, (1 + y)/2}, or 'transparent': the picture has alpha, and only mirrors, glass and light see sky or the default. If all pictures of the script have the form gr.render{...} without background, the default is light and neutral.
---@field mirror? boolean mirror (true or false; default false): Whether the sky cross is mirrored.
---@field integrator? 'whitted'|'path'|'radiosity' integrator ('whitted'|'path'|'radiosity'; default --integrator): The method: whitted has direct light, mirrors and glass; path also has indirect light from all surfaces; radiosity has whitted's mirrors and glass, and stored light that diffuse surfaces exchange.
---@field samples? integer samples (a whole number, 1 to 64; default -ss): N x N samples for a marked pixel.
---@field full? boolean full (true or false; default -full): N x N samples for every pixel, not only for marked ones.
---@field side_tolerance? number side_tolerance (a number, >= 0; default -side-tolerance): A pixel is marked when the squared RGB distance to a side neighbour exceeds X.
---@field corner_tolerance? number corner_tolerance (a number, >= 0; default -corner-tolerance): The same for the corner neighbours.
---@field reflect_limit? integer reflect_limit (a whole number, 0 to 1000; default -reflect-limit): How often a path may reflect.
---@field refract_limit? integer refract_limit (a whole number, 0 to 1000; default -refract-limit): How often a path may refract.
---@field use_tir? boolean use_tir (true or false; default -use-tir): At total internal reflection, add the refracted amount to the reflected one; without it, that light is lost.
---@field area_samples? integer area_samples (a whole number, 1 to 64; default -al-samples): N x N shadow rays for each area light.
---@field medium_samples? integer medium_samples (a whole number, 1 to 4096; default --medium-samples): N points on a ray in a medium that scatters or has a density, with shadow rays to all lights.
---@field cutoff? number cutoff (a number, 0 to 1; default --cutoff): Do not trace rays that can change a pixel by less than X, where white is 1; 0: trace all rays.
---@field spp? integer spp (a whole number, 1 to 16777216; default --spp): N samples for a pixel, with integrator path.
---@field max_depth? integer max_depth (a whole number, 0 to 1000000; default --max-depth): A path is scattered at most N times: 0 shows emission only, 1 direct light, 2 one indirect bounce.
---@field noise? number noise (a number, 1e-06 to 10; default --noise): With integrator path, a tile of 32 x 32 pixels gets samples (at least 16, at most --spp) until its relative standard error is X.
---@field clamp? number clamp (a number, >= 0; default --clamp): With integrator path, no component of a sample is larger than X, 0: no limit; less noise, but the picture becomes darker than it should be (bias).
---@field radiosity_error? number radiosity_error (a number, 1e-09 to 1; default --radiosity-error): Stop when the share X of light is not yet shot, with integrator radiosity.
---@field radiosity_patches? integer radiosity_patches (a whole number, 1 to 10000000; default --radiosity-patches): At most N patches, with integrator radiosity.
---@field filter? 'box'|'tent'|'gaussian'|'mitchell' filter ('box'|'tent'|'gaussian'|'mitchell'; default --filter): Reconstruction filter of a pixel.
---@field resolve? 'mean'|'bright' resolve ('mean'|'bright'; default --resolve): How samples become a pixel, with integrator path; bright: by a mean with the weights 1 / (1 + luminance), after exposure: edges of lamps are smooth, but pixels whose samples differ are darker than their mean (bias).
---@field denoise? boolean denoise (true or false; default --denoise): Remove noise, with integrator path. Without a word gray does; oidn: by the program oidnDenoise of Open Image Denoise, which must be on PATH; none: do not, even if a scene requests it; auto: if a scene requests it.
---@field seed? integer seed (a whole number, 0 to 9.00719925474099e+15; default --seed): Seed of all random numbers; the option also seeds math.random in scripts.
---@field accel? 'auto'|'grid'|'bvh'|'kdtree'|'none' accel ('auto'|'grid'|'bvh'|'kdtree'|'none'; default --accel): Acceleration structure; the picture is the same.
---@field colour? 'auto'|'classic'|'linear' colour ('auto'|'classic'|'linear'; default --colour): linear: decode colour pictures from sRGB and encode PNG files as sRGB; classic: use all numbers unchanged; auto: linear with integrators path and radiosity.
---@field deep? boolean deep (true or false; default --deep): 16 bits per channel in PNG files.
---@field style? 'none'|'ink'|'toon'|'gooch' style ('none'|'ink'|'toon'|'gooch'; default --style): Pictures that look like drawings, with integrator whitted; ink: lines on white paper; toon: a few levels of light; gooch: cool to warm colours.
---@field line_width? number line_width (a number, 0 to 32, in pixels; default --line-width): Width of the lines where objects, normals and depths change.
---@field toon_steps? integer toon_steps (a whole number, 1 to 64; default --toon-steps): Number of levels of light of style toon, not counting shadow.
---@field specular? 'phong'|'blinn' specular ('phong'|'blinn'; default --specular): Formula of the highlight.
---@field exposure? 'auto'|number exposure (a number or 'auto', >= -100 and <= 100, in stops; default --exposure): Multiply light by 2^STOPS when a PNG file is written; auto: as a light meter measures.
---@field tone? 'none'|'reinhard'|'filmic'|fun(x: number): number tone ('none'|'reinhard'|'filmic' or a function; default --tone): Tone curve that maps bright light into the range of a PNG file; a field may also be a function f(x) of the light x from 0 on, the same for red, green and blue.
---@field srgb? boolean srgb (true or false; default --srgb): Encode PNG files with the sRGB transfer function; without it, values are linear.
---@field bloom? number bloom (a number, 0 to 1; default --bloom): Spread light above white to the pixels around it, with the weight X.
---@field vignette? number vignette (a number, 0 to 1; default --vignette): Darken the corners; with X = 1 they have a quarter of their light.
---@field gray? boolean gray (true or false; default --gray): A gray picture: the luminance.
---@field edges? boolean edges (true or false; default --edges): A picture of the edges of the picture, white on black (Sobel); PNG files only.
---@field fxaa? boolean fxaa (true or false; default --fxaa): Smooth the edges of the finished picture (FXAA); PNG files only.
---@field dither? 'none'|'ordered'|'blue' dither ('none'|'ordered'|'blue'; default --dither): Round to 8 bits by a pattern, which removes bands: ordered, or blue noise; PNG files of 8 bits only.
---@field caustics? integer|{photons?: integer, radius?: number} caustics (a number of photons or {photons = ..., radius = ...}; default --caustics): Trace N photons for caustics, the light that glass and mirrors focus; 0: none. A field may also have the radius of the disc that each photon lights (default: from their density).
---@field fog? gr.fog fog (a fog; default none): A fog.
---@field medium? gr.medium medium (a medium; default none): A medium around all solids, instead of a fog.
---@field projection? 'perspective'|'orthographic'|'fisheye'|'panorama' projection ('perspective'|'orthographic'|'fisheye'|'panorama'; default 'perspective'): Fisheye: equidistant, inside a circle; panorama: 360 degrees, longitude by latitude.
---@field view_height? number view_height (a number, > 0; default 2): Height of an orthographic picture, in units of the scene.
---@field angle? number angle (a number, > 0 and <= 360, in degrees; default 180): Full angle of a fisheye across the height.
---@field shift_x? number shift_x (a number, in widths; default 0): Shift of the window to the right.
---@field shift_y? number shift_y (a number, in heights; default 0): Shift of the window upwards.
---@field aperture? number aperture (a number, >= 0; default 0): Radius of the lens, in units of the scene; 0 is a pinhole. With a lens, gray resamples every pixel.
---@field focus? number focus (a number, > 0; default target, else 1): Distance of the plane in focus, along the view.
---@field focus_point? gr.triple focus_point (a point {x, y, z}; optional): A point of the plane in focus, instead of focus.
---@field blades? integer blades (a whole number, 3 to 64; default round): Number of blades: the aperture is a polygon.
---@field blade_angle? number blade_angle (a number, in degrees; default 0): Rotation of that polygon.
---@field stereo? 'none'|'side'|'anaglyph' stereo ('none'|'side'|'anaglyph'; default 'none'): Two eyes: side by side (left picture on the left), or red and cyan.
---@field eye_distance? number eye_distance (a number, >= 0; default screen / 30): Distance between the eyes.
---@field screen? number screen (a number, > 0; default focus): Distance along the view where both eyes, or all views of a light field, see the same point of the picture.
---@field rows? integer rows (a whole number, 1 to 1024; default 9 of gr.light_field): Rows of a light field: a grid of views, each of width x height pixels, in one file.
---@field columns? integer columns (a whole number, 1 to 1024; default 9 of gr.light_field): Its columns.
---@field size? number|number[] size (a number or a table of 2 numbers, 1 to 1048576, in pixels; default width, height): Both in one table: {width, height}; a number alone is a square.
---@field spacing? number spacing (a number, >= 0; default screen / 100): Distance between neighbouring cameras of a light field.
---@field depth? boolean depth (true or false; default false): Whether a light field keeps the depths of its pixels.
---@field shutter? number[] shutter (a table of two rising numbers; default {0, 1}): Times when the shutter opens and closes, {open, close}; motion between them is blurred.
---@field eye_to? gr.triple eye_to (a point {x, y, z}; default eye): Position of a moving camera at time 1.
---@field view_to? gr.triple view_to (a direction {x, y, z}; default view): Its direction of view at time 1.
---@field target_to? gr.triple target_to (a point {x, y, z}; default target): The point to look at, at time 1.
---@field up_to? gr.triple up_to (a direction {x, y, z}; default up): Its up direction at time 1.
---@field model? gr.node model (a node; default node): What -o MODEL writes and --check-print checks, without the ground of the picture.

---Renders a picture into a file.
---@param node gr.node node (a node): Root node of the picture.
---@param file string file (the name of a file; default SCRIPT.png): Picture file: .png, for linear light .pfm .hdr .exr .lf; gray creates missing folders.
---@param width integer width (a whole number, 1 to 1048576, in pixels; default 960): Width of the picture.
---@param height integer height (a whole number, 1 to 1048576, in pixels; default 9/16 of width): Height of the picture.
---@param eye gr.triple eye (a point {x, y, z}; default fits the scene): Position of the camera.
---@param view gr.triple view (a direction {x, y, z}; default {0, 0, -1}): Direction of view.
---@param up gr.triple up (a direction {x, y, z}; default {0, 1, 0}): Direction that is up in the picture.
---@param fov number fov (a number, > 0 and < 180, in degrees; default 50): Full vertical angle of view.
---@param ambient? gr.triple|string ambient (a colour {r, g, b}; default {0, 0, 0}): Ambient light.
---@param lights? gr.light[] lights (a table of lights; default {}): The lights.
---@param fields? gr.render.fields Fields that are no arguments before it
---@overload fun(fields: gr.render.fields)
function gr.render(node, file, width, height, eye, view, up, fov, ambient, lights, fields) end

---@class gr.render_skybox.fields
---@field node gr.node node (a node): Root node of the picture.
---@field file? string file (the name of a file; default SCRIPT.png): Picture file: .png, for linear light .pfm .hdr .exr .lf; gray creates missing folders.
---@field sky? string|gr.texture|gr.sky sky (the name of a picture file or a texture or a sky; optional): Background that is also light: a sky, or a picture of the whole sphere, twice as wide as high. A picture with six views in a 4 x 3 cross is background only.
---@field width? integer width (a whole number, 1 to 1048576, in pixels; default 960): Width of the picture.
---@field height? integer height (a whole number, 1 to 1048576, in pixels; default 9/16 of width): Height of the picture.
---@field eye? gr.triple eye (a point {x, y, z}; default fits the scene): Position of the camera.
---@field view? gr.triple view (a direction {x, y, z}; default {0, 0, -1}): Direction of view.
---@field up? gr.triple up (a direction {x, y, z}; default {0, 1, 0}): Direction that is up in the picture.
---@field fov? number fov (a number, > 0 and < 180, in degrees; default 50): Full vertical angle of view.
---@field ambient? gr.triple|string ambient (a colour {r, g, b}; default {0, 0, 0}): Ambient light.
---@field lights? gr.light[] lights (a table of lights; default {}): The lights.
---@field target? gr.triple target (a point {x, y, z}; optional): Point to look at, instead of view.
---@field background? gr.triple|string|gr.sky|gr.texture|function|'gradient' background (a colour {r, g, b}, a sky, a function or 'gradient'; default 'gradient'): Background for rays that hit nothing: a colour, a sky, a function of the unit direction, 'gradient' for {0, 0, (1 + y)/2}, or 'transparent': the picture has alpha, and only mirrors, glass and light see sky or the default. If all pictures of the script have the form gr.render{...} without background, the default is light and neutral.
---@field mirror? boolean mirror (true or false; default false): Whether the sky cross is mirrored.
---@field integrator? 'whitted'|'path'|'radiosity' integrator ('whitted'|'path'|'radiosity'; default --integrator): The method: whitted has direct light, mirrors and glass; path also has indirect light from all surfaces; radiosity has whitted's mirrors and glass, and stored light that diffuse surfaces exchange.
---@field samples? integer samples (a whole number, 1 to 64; default -ss): N x N samples for a marked pixel.
---@field full? boolean full (true or false; default -full): N x N samples for every pixel, not only for marked ones.
---@field side_tolerance? number side_tolerance (a number, >= 0; default -side-tolerance): A pixel is marked when the squared RGB distance to a side neighbour exceeds X.
---@field corner_tolerance? number corner_tolerance (a number, >= 0; default -corner-tolerance): The same for the corner neighbours.
---@field reflect_limit? integer reflect_limit (a whole number, 0 to 1000; default -reflect-limit): How often a path may reflect.
---@field refract_limit? integer refract_limit (a whole number, 0 to 1000; default -refract-limit): How often a path may refract.
---@field use_tir? boolean use_tir (true or false; default -use-tir): At total internal reflection, add the refracted amount to the reflected one; without it, that light is lost.
---@field area_samples? integer area_samples (a whole number, 1 to 64; default -al-samples): N x N shadow rays for each area light.
---@field medium_samples? integer medium_samples (a whole number, 1 to 4096; default --medium-samples): N points on a ray in a medium that scatters or has a density, with shadow rays to all lights.
---@field cutoff? number cutoff (a number, 0 to 1; default --cutoff): Do not trace rays that can change a pixel by less than X, where white is 1; 0: trace all rays.
---@field spp? integer spp (a whole number, 1 to 16777216; default --spp): N samples for a pixel, with integrator path.
---@field max_depth? integer max_depth (a whole number, 0 to 1000000; default --max-depth): A path is scattered at most N times: 0 shows emission only, 1 direct light, 2 one indirect bounce.
---@field noise? number noise (a number, 1e-06 to 10; default --noise): With integrator path, a tile of 32 x 32 pixels gets samples (at least 16, at most --spp) until its relative standard error is X.
---@field clamp? number clamp (a number, >= 0; default --clamp): With integrator path, no component of a sample is larger than X, 0: no limit; less noise, but the picture becomes darker than it should be (bias).
---@field radiosity_error? number radiosity_error (a number, 1e-09 to 1; default --radiosity-error): Stop when the share X of light is not yet shot, with integrator radiosity.
---@field radiosity_patches? integer radiosity_patches (a whole number, 1 to 10000000; default --radiosity-patches): At most N patches, with integrator radiosity.
---@field filter? 'box'|'tent'|'gaussian'|'mitchell' filter ('box'|'tent'|'gaussian'|'mitchell'; default --filter): Reconstruction filter of a pixel.
---@field resolve? 'mean'|'bright' resolve ('mean'|'bright'; default --resolve): How samples become a pixel, with integrator path; bright: by a mean with the weights 1 / (1 + luminance), after exposure: edges of lamps are smooth, but pixels whose samples differ are darker than their mean (bias).
---@field denoise? boolean denoise (true or false; default --denoise): Remove noise, with integrator path. Without a word gray does; oidn: by the program oidnDenoise of Open Image Denoise, which must be on PATH; none: do not, even if a scene requests it; auto: if a scene requests it.
---@field seed? integer seed (a whole number, 0 to 9.00719925474099e+15; default --seed): Seed of all random numbers; the option also seeds math.random in scripts.
---@field accel? 'auto'|'grid'|'bvh'|'kdtree'|'none' accel ('auto'|'grid'|'bvh'|'kdtree'|'none'; default --accel): Acceleration structure; the picture is the same.
---@field colour? 'auto'|'classic'|'linear' colour ('auto'|'classic'|'linear'; default --colour): linear: decode colour pictures from sRGB and encode PNG files as sRGB; classic: use all numbers unchanged; auto: linear with integrators path and radiosity.
---@field deep? boolean deep (true or false; default --deep): 16 bits per channel in PNG files.
---@field style? 'none'|'ink'|'toon'|'gooch' style ('none'|'ink'|'toon'|'gooch'; default --style): Pictures that look like drawings, with integrator whitted; ink: lines on white paper; toon: a few levels of light; gooch: cool to warm colours.
---@field line_width? number line_width (a number, 0 to 32, in pixels; default --line-width): Width of the lines where objects, normals and depths change.
---@field toon_steps? integer toon_steps (a whole number, 1 to 64; default --toon-steps): Number of levels of light of style toon, not counting shadow.
---@field specular? 'phong'|'blinn' specular ('phong'|'blinn'; default --specular): Formula of the highlight.
---@field exposure? 'auto'|number exposure (a number or 'auto', >= -100 and <= 100, in stops; default --exposure): Multiply light by 2^STOPS when a PNG file is written; auto: as a light meter measures.
---@field tone? 'none'|'reinhard'|'filmic'|fun(x: number): number tone ('none'|'reinhard'|'filmic' or a function; default --tone): Tone curve that maps bright light into the range of a PNG file; a field may also be a function f(x) of the light x from 0 on, the same for red, green and blue.
---@field srgb? boolean srgb (true or false; default --srgb): Encode PNG files with the sRGB transfer function; without it, values are linear.
---@field bloom? number bloom (a number, 0 to 1; default --bloom): Spread light above white to the pixels around it, with the weight X.
---@field vignette? number vignette (a number, 0 to 1; default --vignette): Darken the corners; with X = 1 they have a quarter of their light.
---@field gray? boolean gray (true or false; default --gray): A gray picture: the luminance.
---@field edges? boolean edges (true or false; default --edges): A picture of the edges of the picture, white on black (Sobel); PNG files only.
---@field fxaa? boolean fxaa (true or false; default --fxaa): Smooth the edges of the finished picture (FXAA); PNG files only.
---@field dither? 'none'|'ordered'|'blue' dither ('none'|'ordered'|'blue'; default --dither): Round to 8 bits by a pattern, which removes bands: ordered, or blue noise; PNG files of 8 bits only.
---@field caustics? integer|{photons?: integer, radius?: number} caustics (a number of photons or {photons = ..., radius = ...}; default --caustics): Trace N photons for caustics, the light that glass and mirrors focus; 0: none. A field may also have the radius of the disc that each photon lights (default: from their density).
---@field fog? gr.fog fog (a fog; default none): A fog.
---@field medium? gr.medium medium (a medium; default none): A medium around all solids, instead of a fog.
---@field projection? 'perspective'|'orthographic'|'fisheye'|'panorama' projection ('perspective'|'orthographic'|'fisheye'|'panorama'; default 'perspective'): Fisheye: equidistant, inside a circle; panorama: 360 degrees, longitude by latitude.
---@field view_height? number view_height (a number, > 0; default 2): Height of an orthographic picture, in units of the scene.
---@field angle? number angle (a number, > 0 and <= 360, in degrees; default 180): Full angle of a fisheye across the height.
---@field shift_x? number shift_x (a number, in widths; default 0): Shift of the window to the right.
---@field shift_y? number shift_y (a number, in heights; default 0): Shift of the window upwards.
---@field aperture? number aperture (a number, >= 0; default 0): Radius of the lens, in units of the scene; 0 is a pinhole. With a lens, gray resamples every pixel.
---@field focus? number focus (a number, > 0; default target, else 1): Distance of the plane in focus, along the view.
---@field focus_point? gr.triple focus_point (a point {x, y, z}; optional): A point of the plane in focus, instead of focus.
---@field blades? integer blades (a whole number, 3 to 64; default round): Number of blades: the aperture is a polygon.
---@field blade_angle? number blade_angle (a number, in degrees; default 0): Rotation of that polygon.
---@field stereo? 'none'|'side'|'anaglyph' stereo ('none'|'side'|'anaglyph'; default 'none'): Two eyes: side by side (left picture on the left), or red and cyan.
---@field eye_distance? number eye_distance (a number, >= 0; default screen / 30): Distance between the eyes.
---@field screen? number screen (a number, > 0; default focus): Distance along the view where both eyes, or all views of a light field, see the same point of the picture.
---@field rows? integer rows (a whole number, 1 to 1024; default 9 of gr.light_field): Rows of a light field: a grid of views, each of width x height pixels, in one file.
---@field columns? integer columns (a whole number, 1 to 1024; default 9 of gr.light_field): Its columns.
---@field size? number|number[] size (a number or a table of 2 numbers, 1 to 1048576, in pixels; default width, height): Both in one table: {width, height}; a number alone is a square.
---@field spacing? number spacing (a number, >= 0; default screen / 100): Distance between neighbouring cameras of a light field.
---@field depth? boolean depth (true or false; default false): Whether a light field keeps the depths of its pixels.
---@field shutter? number[] shutter (a table of two rising numbers; default {0, 1}): Times when the shutter opens and closes, {open, close}; motion between them is blurred.
---@field eye_to? gr.triple eye_to (a point {x, y, z}; default eye): Position of a moving camera at time 1.
---@field view_to? gr.triple view_to (a direction {x, y, z}; default view): Its direction of view at time 1.
---@field target_to? gr.triple target_to (a point {x, y, z}; default target): The point to look at, at time 1.
---@field up_to? gr.triple up_to (a direction {x, y, z}; default up): Its up direction at time 1.
---@field model? gr.node model (a node; default node): What -o MODEL writes and --check-print checks, without the ground of the picture.

---The same as gr.render, with a sky picture.
---@param node gr.node node (a node): Root node of the picture.
---@param file string file (the name of a file; default SCRIPT.png): Picture file: .png, for linear light .pfm .hdr .exr .lf; gray creates missing folders.
---@param sky string|gr.texture|gr.sky sky (the name of a picture file or a texture or a sky; optional): Background that is also light: a sky, or a picture of the whole sphere, twice as wide as high. A picture with six views in a 4 x 3 cross is background only.
---@param width integer width (a whole number, 1 to 1048576, in pixels; default 960): Width of the picture.
---@param height integer height (a whole number, 1 to 1048576, in pixels; default 9/16 of width): Height of the picture.
---@param eye gr.triple eye (a point {x, y, z}; default fits the scene): Position of the camera.
---@param view gr.triple view (a direction {x, y, z}; default {0, 0, -1}): Direction of view.
---@param up gr.triple up (a direction {x, y, z}; default {0, 1, 0}): Direction that is up in the picture.
---@param fov number fov (a number, > 0 and < 180, in degrees; default 50): Full vertical angle of view.
---@param ambient? gr.triple|string ambient (a colour {r, g, b}; default {0, 0, 0}): Ambient light.
---@param lights? gr.light[] lights (a table of lights; default {}): The lights.
---@param fields? gr.render_skybox.fields Fields that are no arguments before it
---@overload fun(fields: gr.render_skybox.fields)
function gr.render_skybox(node, file, sky, width, height, eye, view, up, fov, ambient, lights, fields) end

---@class gr.light_field.fields
---@field node gr.node node (a node): Root node of the picture.
---@field file? string file (the name of a file; default SCRIPT.png): Picture file: .png, for linear light .pfm .hdr .exr .lf; gray creates missing folders.
---@field sky? string|gr.texture|gr.sky sky (the name of a picture file or a texture or a sky; optional): Background that is also light: a sky, or a picture of the whole sphere, twice as wide as high. A picture with six views in a 4 x 3 cross is background only.
---@field width? integer width (a whole number, 1 to 1048576, in pixels; default 960): Width of the picture.
---@field height? integer height (a whole number, 1 to 1048576, in pixels; default 9/16 of width): Height of the picture.
---@field eye? gr.triple eye (a point {x, y, z}; default fits the scene): Position of the camera.
---@field view? gr.triple view (a direction {x, y, z}; default {0, 0, -1}): Direction of view.
---@field up? gr.triple up (a direction {x, y, z}; default {0, 1, 0}): Direction that is up in the picture.
---@field fov? number fov (a number, > 0 and < 180, in degrees; default 50): Full vertical angle of view.
---@field ambient? gr.triple|string ambient (a colour {r, g, b}; default {0, 0, 0}): Ambient light.
---@field lights? gr.light[] lights (a table of lights; default {}): The lights.
---@field target? gr.triple target (a point {x, y, z}; optional): Point to look at, instead of view.
---@field background? gr.triple|string|gr.sky|gr.texture|function|'gradient' background (a colour {r, g, b}, a sky, a function or 'gradient'; default 'gradient'): Background for rays that hit nothing: a colour, a sky, a function of the unit direction, 'gradient' for {0, 0, (1 + y)/2}, or 'transparent': the picture has alpha, and only mirrors, glass and light see sky or the default. If all pictures of the script have the form gr.render{...} without background, the default is light and neutral.
---@field mirror? boolean mirror (true or false; default false): Whether the sky cross is mirrored.
---@field integrator? 'whitted'|'path'|'radiosity' integrator ('whitted'|'path'|'radiosity'; default --integrator): The method: whitted has direct light, mirrors and glass; path also has indirect light from all surfaces; radiosity has whitted's mirrors and glass, and stored light that diffuse surfaces exchange.
---@field samples? integer samples (a whole number, 1 to 64; default -ss): N x N samples for a marked pixel.
---@field full? boolean full (true or false; default -full): N x N samples for every pixel, not only for marked ones.
---@field side_tolerance? number side_tolerance (a number, >= 0; default -side-tolerance): A pixel is marked when the squared RGB distance to a side neighbour exceeds X.
---@field corner_tolerance? number corner_tolerance (a number, >= 0; default -corner-tolerance): The same for the corner neighbours.
---@field reflect_limit? integer reflect_limit (a whole number, 0 to 1000; default -reflect-limit): How often a path may reflect.
---@field refract_limit? integer refract_limit (a whole number, 0 to 1000; default -refract-limit): How often a path may refract.
---@field use_tir? boolean use_tir (true or false; default -use-tir): At total internal reflection, add the refracted amount to the reflected one; without it, that light is lost.
---@field area_samples? integer area_samples (a whole number, 1 to 64; default -al-samples): N x N shadow rays for each area light.
---@field medium_samples? integer medium_samples (a whole number, 1 to 4096; default --medium-samples): N points on a ray in a medium that scatters or has a density, with shadow rays to all lights.
---@field cutoff? number cutoff (a number, 0 to 1; default --cutoff): Do not trace rays that can change a pixel by less than X, where white is 1; 0: trace all rays.
---@field spp? integer spp (a whole number, 1 to 16777216; default --spp): N samples for a pixel, with integrator path.
---@field max_depth? integer max_depth (a whole number, 0 to 1000000; default --max-depth): A path is scattered at most N times: 0 shows emission only, 1 direct light, 2 one indirect bounce.
---@field noise? number noise (a number, 1e-06 to 10; default --noise): With integrator path, a tile of 32 x 32 pixels gets samples (at least 16, at most --spp) until its relative standard error is X.
---@field clamp? number clamp (a number, >= 0; default --clamp): With integrator path, no component of a sample is larger than X, 0: no limit; less noise, but the picture becomes darker than it should be (bias).
---@field radiosity_error? number radiosity_error (a number, 1e-09 to 1; default --radiosity-error): Stop when the share X of light is not yet shot, with integrator radiosity.
---@field radiosity_patches? integer radiosity_patches (a whole number, 1 to 10000000; default --radiosity-patches): At most N patches, with integrator radiosity.
---@field filter? 'box'|'tent'|'gaussian'|'mitchell' filter ('box'|'tent'|'gaussian'|'mitchell'; default --filter): Reconstruction filter of a pixel.
---@field resolve? 'mean'|'bright' resolve ('mean'|'bright'; default --resolve): How samples become a pixel, with integrator path; bright: by a mean with the weights 1 / (1 + luminance), after exposure: edges of lamps are smooth, but pixels whose samples differ are darker than their mean (bias).
---@field denoise? boolean denoise (true or false; default --denoise): Remove noise, with integrator path. Without a word gray does; oidn: by the program oidnDenoise of Open Image Denoise, which must be on PATH; none: do not, even if a scene requests it; auto: if a scene requests it.
---@field seed? integer seed (a whole number, 0 to 9.00719925474099e+15; default --seed): Seed of all random numbers; the option also seeds math.random in scripts.
---@field accel? 'auto'|'grid'|'bvh'|'kdtree'|'none' accel ('auto'|'grid'|'bvh'|'kdtree'|'none'; default --accel): Acceleration structure; the picture is the same.
---@field colour? 'auto'|'classic'|'linear' colour ('auto'|'classic'|'linear'; default --colour): linear: decode colour pictures from sRGB and encode PNG files as sRGB; classic: use all numbers unchanged; auto: linear with integrators path and radiosity.
---@field deep? boolean deep (true or false; default --deep): 16 bits per channel in PNG files.
---@field style? 'none'|'ink'|'toon'|'gooch' style ('none'|'ink'|'toon'|'gooch'; default --style): Pictures that look like drawings, with integrator whitted; ink: lines on white paper; toon: a few levels of light; gooch: cool to warm colours.
---@field line_width? number line_width (a number, 0 to 32, in pixels; default --line-width): Width of the lines where objects, normals and depths change.
---@field toon_steps? integer toon_steps (a whole number, 1 to 64; default --toon-steps): Number of levels of light of style toon, not counting shadow.
---@field specular? 'phong'|'blinn' specular ('phong'|'blinn'; default --specular): Formula of the highlight.
---@field exposure? 'auto'|number exposure (a number or 'auto', >= -100 and <= 100, in stops; default --exposure): Multiply light by 2^STOPS when a PNG file is written; auto: as a light meter measures.
---@field tone? 'none'|'reinhard'|'filmic'|fun(x: number): number tone ('none'|'reinhard'|'filmic' or a function; default --tone): Tone curve that maps bright light into the range of a PNG file; a field may also be a function f(x) of the light x from 0 on, the same for red, green and blue.
---@field srgb? boolean srgb (true or false; default --srgb): Encode PNG files with the sRGB transfer function; without it, values are linear.
---@field bloom? number bloom (a number, 0 to 1; default --bloom): Spread light above white to the pixels around it, with the weight X.
---@field vignette? number vignette (a number, 0 to 1; default --vignette): Darken the corners; with X = 1 they have a quarter of their light.
---@field gray? boolean gray (true or false; default --gray): A gray picture: the luminance.
---@field edges? boolean edges (true or false; default --edges): A picture of the edges of the picture, white on black (Sobel); PNG files only.
---@field fxaa? boolean fxaa (true or false; default --fxaa): Smooth the edges of the finished picture (FXAA); PNG files only.
---@field dither? 'none'|'ordered'|'blue' dither ('none'|'ordered'|'blue'; default --dither): Round to 8 bits by a pattern, which removes bands: ordered, or blue noise; PNG files of 8 bits only.
---@field caustics? integer|{photons?: integer, radius?: number} caustics (a number of photons or {photons = ..., radius = ...}; default --caustics): Trace N photons for caustics, the light that glass and mirrors focus; 0: none. A field may also have the radius of the disc that each photon lights (default: from their density).
---@field fog? gr.fog fog (a fog; default none): A fog.
---@field medium? gr.medium medium (a medium; default none): A medium around all solids, instead of a fog.
---@field projection? 'perspective'|'orthographic'|'fisheye'|'panorama' projection ('perspective'|'orthographic'|'fisheye'|'panorama'; default 'perspective'): Fisheye: equidistant, inside a circle; panorama: 360 degrees, longitude by latitude.
---@field view_height? number view_height (a number, > 0; default 2): Height of an orthographic picture, in units of the scene.
---@field angle? number angle (a number, > 0 and <= 360, in degrees; default 180): Full angle of a fisheye across the height.
---@field shift_x? number shift_x (a number, in widths; default 0): Shift of the window to the right.
---@field shift_y? number shift_y (a number, in heights; default 0): Shift of the window upwards.
---@field aperture? number aperture (a number, >= 0; default 0): Radius of the lens, in units of the scene; 0 is a pinhole. With a lens, gray resamples every pixel.
---@field focus? number focus (a number, > 0; default target, else 1): Distance of the plane in focus, along the view.
---@field focus_point? gr.triple focus_point (a point {x, y, z}; optional): A point of the plane in focus, instead of focus.
---@field blades? integer blades (a whole number, 3 to 64; default round): Number of blades: the aperture is a polygon.
---@field blade_angle? number blade_angle (a number, in degrees; default 0): Rotation of that polygon.
---@field stereo? 'none'|'side'|'anaglyph' stereo ('none'|'side'|'anaglyph'; default 'none'): Two eyes: side by side (left picture on the left), or red and cyan.
---@field eye_distance? number eye_distance (a number, >= 0; default screen / 30): Distance between the eyes.
---@field screen? number screen (a number, > 0; default focus): Distance along the view where both eyes, or all views of a light field, see the same point of the picture.
---@field rows? integer rows (a whole number, 1 to 1024; default 9 of gr.light_field): Rows of a light field: a grid of views, each of width x height pixels, in one file.
---@field columns? integer columns (a whole number, 1 to 1024; default 9 of gr.light_field): Its columns.
---@field size? number|number[] size (a number or a table of 2 numbers, 1 to 1048576, in pixels; default width, height): Both in one table: {width, height}; a number alone is a square.
---@field spacing? number spacing (a number, >= 0; default screen / 100): Distance between neighbouring cameras of a light field.
---@field depth? boolean depth (true or false; default false): Whether a light field keeps the depths of its pixels.
---@field shutter? number[] shutter (a table of two rising numbers; default {0, 1}): Times when the shutter opens and closes, {open, close}; motion between them is blurred.
---@field eye_to? gr.triple eye_to (a point {x, y, z}; default eye): Position of a moving camera at time 1.
---@field view_to? gr.triple view_to (a direction {x, y, z}; default view): Its direction of view at time 1.
---@field target_to? gr.triple target_to (a point {x, y, z}; default target): The point to look at, at time 1.
---@field up_to? gr.triple up_to (a direction {x, y, z}; default up): Its up direction at time 1.
---@field model? gr.node model (a node; default node): What -o MODEL writes and --check-print checks, without the ground of the picture.

---Renders a light field: the pictures of a grid of cameras, in one file.
---@param node gr.node node (a node): Root node of the picture.
---@param file string file (the name of a file; default SCRIPT.png): Picture file: .png, for linear light .pfm .hdr .exr .lf; gray creates missing folders.
---@param fields? gr.light_field.fields Fields that are no arguments before it
---@overload fun(fields: gr.light_field.fields)
function gr.light_field(node, file, fields) end

---@class gr.transform_order.fields
---@field order 'new'|'old'|'separate' order ('new'|'old'|'separate'): new: calls act in the order in which they are written; old: the last call acts first; separate: scale, then rotate, then translate.

---Selects how scale, rotate and translate compose in this script.
---@param order 'new'|'old'|'separate' order ('new'|'old'|'separate'): new: calls act in the order in which they are written; old: the last call acts first; separate: scale, then rotate, then translate.
---@overload fun(fields: gr.transform_order.fields)
function gr.transform_order(order) end

---Adds a child to this node.
---@param node gr.node node (a node): The child; a node under several parents is an instance.
---@return gr.node
function node:add_child(node) end

---Returns the bounding box of this node and its children, with its own transforms: smallest and largest x, y, z.
---@return number[]
---@return number[]
function node:bounds() end

---Returns the vertices and faces of a mesh, in object space, as gr.mesh accepts them.
---@return number[][]
---@return integer[][]
function node:faces() end

---Sets the material of a shape.
---@param material gr.material material (a material): Material of the surface.
---@return gr.node
function node:set_material(material) end

---Replaces kd of a shape by an image.
---@param texture string|gr.texture texture (the name of a picture file or a texture): A texture, or the name of a picture file.
---@return gr.node
function node:set_texture(texture) end

---Sets the bump map of a shape.
---@param bump string|gr.texture|function bump (the name of a picture file or a texture): A result of gr.bump, or the name of a picture file.
---@return gr.node
function node:set_bump(bump) end

---Scales this node.
---@param x number x (a number): Factor along x.
---@param y number y (a number): Factor along y.
---@param z number z (a number): Factor along z.
---@return gr.node
---@overload fun(self: gr.node, vector: gr.triple): gr.node
function node:scale(x, y, z) end

---Rotates this node about an axis.
---@param axis 'x'|'y'|'z' axis ('x', 'y' or 'z'): The axis, in either case.
---@param angle number angle (a number, in degrees): Angle, counterclockwise when the axis points to the viewer.
---@return gr.node
function node:rotate(axis, angle) end

---Sets the velocity of this node per second while the shutter is open; its transforms are its pose at time 0.
---@param x number x (a number): Distance along x per second, in the space of the parent.
---@param y number y (a number): Distance along y.
---@param z number z (a number): Distance along z.
---@return gr.node
---@overload fun(self: gr.node, vector: gr.triple): gr.node
function node:velocity(x, y, z) end

---Moves this node from its own pose at time 0 to the pose of another node at time 1, on the shorter rotation.
---@param node gr.node node (a node): A node whose own transforms are the pose of this one at time 1; it need not be in the scene.
---@return gr.node
function node:moves_to(node) end

---Rotates this node at a constant rate about an axis through the origin of its own space, before its transforms.
---@param axis 'x'|'y'|'z' axis ('x', 'y' or 'z'): The axis.
---@param degrees number degrees (a number, in degrees): Angle per second; 0: none.
---@return gr.node
---@overload fun(self: gr.node, direction: gr.triple, degrees: number): gr.node
function node:spin(axis, degrees) end

---Removes the transforms of this node, so that an animation can set new ones in each frame.
---@return gr.node
function node:reset() end

---@class gr.node.pose.fields
---@field translate? gr.triple translate (a point {x, y, z}; default {0, 0, 0}): Translation, the last step.
---@field rotate? number[] rotate (a table of 4 numbers {w, x, y, z}; default {1, 0, 0, 0}): Rotation, a quaternion {w, x, y, z} as for node:rotate_quat.
---@field scale? number|gr.triple scale (a number or a table of 3 numbers; default 1): Scale factor, the first step, one number or three; of 0 nothing is drawn.

---Replaces the transforms of this node by a scale, a rotation and a translation, as gr.keys interpolates them.
---@param translate gr.triple translate (a point {x, y, z}; default {0, 0, 0}): Translation, the last step.
---@param rotate? number[] rotate (a table of 4 numbers {w, x, y, z}; default {1, 0, 0, 0}): Rotation, a quaternion {w, x, y, z} as for node:rotate_quat.
---@param scale? number|gr.triple scale (a number or a table of 3 numbers; default 1): Scale factor, the first step, one number or three; of 0 nothing is drawn.
---@return gr.node
---@overload fun(self: gr.node, fields: gr.node.pose.fields): gr.node
function node:pose(translate, rotate, scale) end

---Rotates this node about any direction.
---@param axis gr.triple axis (a direction {x, y, z}): The axis, of any length except 0.
---@param angle number angle (a number, in degrees): Angle, counterclockwise when the axis points to the viewer.
---@return gr.node
function node:rotate_axis(axis, angle) end

---Rotates this node by a quaternion.
---@param w number w (a number): Cosine of half the angle; gray normalises the quaternion.
---@param x number x (a number): x of the unit axis, times the sine of half the angle.
---@param y number y (a number): The same for y.
---@param z number z (a number): The same for z.
---@return gr.node
---@overload fun(self: gr.node, quaternion: number[]): gr.node
function node:rotate_quat(w, x, y, z) end

---Translates this node.
---@param x number x (a number): Distance along x.
---@param y number y (a number): Distance along y.
---@param z number z (a number): Distance along z.
---@return gr.node
---@overload fun(self: gr.node, vector: gr.triple): gr.node
function node:translate(x, y, z) end

---@class gr.node.render.fields
---@field file? string file (the name of a file; default SCRIPT.png): Picture file: .png, for linear light .pfm .hdr .exr .lf; gray creates missing folders.
---@field sky? string|gr.texture|gr.sky sky (the name of a picture file or a texture or a sky; optional): Background that is also light: a sky, or a picture of the whole sphere, twice as wide as high. A picture with six views in a 4 x 3 cross is background only.
---@field width? integer width (a whole number, 1 to 1048576, in pixels; default 960): Width of the picture.
---@field height? integer height (a whole number, 1 to 1048576, in pixels; default 9/16 of width): Height of the picture.
---@field eye? gr.triple eye (a point {x, y, z}; default fits the scene): Position of the camera.
---@field view? gr.triple view (a direction {x, y, z}; default {0, 0, -1}): Direction of view.
---@field up? gr.triple up (a direction {x, y, z}; default {0, 1, 0}): Direction that is up in the picture.
---@field fov? number fov (a number, > 0 and < 180, in degrees; default 50): Full vertical angle of view.
---@field ambient? gr.triple|string ambient (a colour {r, g, b}; default {0, 0, 0}): Ambient light.
---@field lights? gr.light[] lights (a table of lights; default {}): The lights.
---@field target? gr.triple target (a point {x, y, z}; optional): Point to look at, instead of view.
---@field background? gr.triple|string|gr.sky|gr.texture|function|'gradient' background (a colour {r, g, b}, a sky, a function or 'gradient'; default 'gradient'): Background for rays that hit nothing: a colour, a sky, a function of the unit direction, 'gradient' for {0, 0, (1 + y)/2}, or 'transparent': the picture has alpha, and only mirrors, glass and light see sky or the default. If all pictures of the script have the form gr.render{...} without background, the default is light and neutral.
---@field mirror? boolean mirror (true or false; default false): Whether the sky cross is mirrored.
---@field integrator? 'whitted'|'path'|'radiosity' integrator ('whitted'|'path'|'radiosity'; default --integrator): The method: whitted has direct light, mirrors and glass; path also has indirect light from all surfaces; radiosity has whitted's mirrors and glass, and stored light that diffuse surfaces exchange.
---@field samples? integer samples (a whole number, 1 to 64; default -ss): N x N samples for a marked pixel.
---@field full? boolean full (true or false; default -full): N x N samples for every pixel, not only for marked ones.
---@field side_tolerance? number side_tolerance (a number, >= 0; default -side-tolerance): A pixel is marked when the squared RGB distance to a side neighbour exceeds X.
---@field corner_tolerance? number corner_tolerance (a number, >= 0; default -corner-tolerance): The same for the corner neighbours.
---@field reflect_limit? integer reflect_limit (a whole number, 0 to 1000; default -reflect-limit): How often a path may reflect.
---@field refract_limit? integer refract_limit (a whole number, 0 to 1000; default -refract-limit): How often a path may refract.
---@field use_tir? boolean use_tir (true or false; default -use-tir): At total internal reflection, add the refracted amount to the reflected one; without it, that light is lost.
---@field area_samples? integer area_samples (a whole number, 1 to 64; default -al-samples): N x N shadow rays for each area light.
---@field medium_samples? integer medium_samples (a whole number, 1 to 4096; default --medium-samples): N points on a ray in a medium that scatters or has a density, with shadow rays to all lights.
---@field cutoff? number cutoff (a number, 0 to 1; default --cutoff): Do not trace rays that can change a pixel by less than X, where white is 1; 0: trace all rays.
---@field spp? integer spp (a whole number, 1 to 16777216; default --spp): N samples for a pixel, with integrator path.
---@field max_depth? integer max_depth (a whole number, 0 to 1000000; default --max-depth): A path is scattered at most N times: 0 shows emission only, 1 direct light, 2 one indirect bounce.
---@field noise? number noise (a number, 1e-06 to 10; default --noise): With integrator path, a tile of 32 x 32 pixels gets samples (at least 16, at most --spp) until its relative standard error is X.
---@field clamp? number clamp (a number, >= 0; default --clamp): With integrator path, no component of a sample is larger than X, 0: no limit; less noise, but the picture becomes darker than it should be (bias).
---@field radiosity_error? number radiosity_error (a number, 1e-09 to 1; default --radiosity-error): Stop when the share X of light is not yet shot, with integrator radiosity.
---@field radiosity_patches? integer radiosity_patches (a whole number, 1 to 10000000; default --radiosity-patches): At most N patches, with integrator radiosity.
---@field filter? 'box'|'tent'|'gaussian'|'mitchell' filter ('box'|'tent'|'gaussian'|'mitchell'; default --filter): Reconstruction filter of a pixel.
---@field resolve? 'mean'|'bright' resolve ('mean'|'bright'; default --resolve): How samples become a pixel, with integrator path; bright: by a mean with the weights 1 / (1 + luminance), after exposure: edges of lamps are smooth, but pixels whose samples differ are darker than their mean (bias).
---@field denoise? boolean denoise (true or false; default --denoise): Remove noise, with integrator path. Without a word gray does; oidn: by the program oidnDenoise of Open Image Denoise, which must be on PATH; none: do not, even if a scene requests it; auto: if a scene requests it.
---@field seed? integer seed (a whole number, 0 to 9.00719925474099e+15; default --seed): Seed of all random numbers; the option also seeds math.random in scripts.
---@field accel? 'auto'|'grid'|'bvh'|'kdtree'|'none' accel ('auto'|'grid'|'bvh'|'kdtree'|'none'; default --accel): Acceleration structure; the picture is the same.
---@field colour? 'auto'|'classic'|'linear' colour ('auto'|'classic'|'linear'; default --colour): linear: decode colour pictures from sRGB and encode PNG files as sRGB; classic: use all numbers unchanged; auto: linear with integrators path and radiosity.
---@field deep? boolean deep (true or false; default --deep): 16 bits per channel in PNG files.
---@field style? 'none'|'ink'|'toon'|'gooch' style ('none'|'ink'|'toon'|'gooch'; default --style): Pictures that look like drawings, with integrator whitted; ink: lines on white paper; toon: a few levels of light; gooch: cool to warm colours.
---@field line_width? number line_width (a number, 0 to 32, in pixels; default --line-width): Width of the lines where objects, normals and depths change.
---@field toon_steps? integer toon_steps (a whole number, 1 to 64; default --toon-steps): Number of levels of light of style toon, not counting shadow.
---@field specular? 'phong'|'blinn' specular ('phong'|'blinn'; default --specular): Formula of the highlight.
---@field exposure? 'auto'|number exposure (a number or 'auto', >= -100 and <= 100, in stops; default --exposure): Multiply light by 2^STOPS when a PNG file is written; auto: as a light meter measures.
---@field tone? 'none'|'reinhard'|'filmic'|fun(x: number): number tone ('none'|'reinhard'|'filmic' or a function; default --tone): Tone curve that maps bright light into the range of a PNG file; a field may also be a function f(x) of the light x from 0 on, the same for red, green and blue.
---@field srgb? boolean srgb (true or false; default --srgb): Encode PNG files with the sRGB transfer function; without it, values are linear.
---@field bloom? number bloom (a number, 0 to 1; default --bloom): Spread light above white to the pixels around it, with the weight X.
---@field vignette? number vignette (a number, 0 to 1; default --vignette): Darken the corners; with X = 1 they have a quarter of their light.
---@field gray? boolean gray (true or false; default --gray): A gray picture: the luminance.
---@field edges? boolean edges (true or false; default --edges): A picture of the edges of the picture, white on black (Sobel); PNG files only.
---@field fxaa? boolean fxaa (true or false; default --fxaa): Smooth the edges of the finished picture (FXAA); PNG files only.
---@field dither? 'none'|'ordered'|'blue' dither ('none'|'ordered'|'blue'; default --dither): Round to 8 bits by a pattern, which removes bands: ordered, or blue noise; PNG files of 8 bits only.
---@field caustics? integer|{photons?: integer, radius?: number} caustics (a number of photons or {photons = ..., radius = ...}; default --caustics): Trace N photons for caustics, the light that glass and mirrors focus; 0: none. A field may also have the radius of the disc that each photon lights (default: from their density).
---@field fog? gr.fog fog (a fog; default none): A fog.
---@field medium? gr.medium medium (a medium; default none): A medium around all solids, instead of a fog.
---@field projection? 'perspective'|'orthographic'|'fisheye'|'panorama' projection ('perspective'|'orthographic'|'fisheye'|'panorama'; default 'perspective'): Fisheye: equidistant, inside a circle; panorama: 360 degrees, longitude by latitude.
---@field view_height? number view_height (a number, > 0; default 2): Height of an orthographic picture, in units of the scene.
---@field angle? number angle (a number, > 0 and <= 360, in degrees; default 180): Full angle of a fisheye across the height.
---@field shift_x? number shift_x (a number, in widths; default 0): Shift of the window to the right.
---@field shift_y? number shift_y (a number, in heights; default 0): Shift of the window upwards.
---@field aperture? number aperture (a number, >= 0; default 0): Radius of the lens, in units of the scene; 0 is a pinhole. With a lens, gray resamples every pixel.
---@field focus? number focus (a number, > 0; default target, else 1): Distance of the plane in focus, along the view.
---@field focus_point? gr.triple focus_point (a point {x, y, z}; optional): A point of the plane in focus, instead of focus.
---@field blades? integer blades (a whole number, 3 to 64; default round): Number of blades: the aperture is a polygon.
---@field blade_angle? number blade_angle (a number, in degrees; default 0): Rotation of that polygon.
---@field stereo? 'none'|'side'|'anaglyph' stereo ('none'|'side'|'anaglyph'; default 'none'): Two eyes: side by side (left picture on the left), or red and cyan.
---@field eye_distance? number eye_distance (a number, >= 0; default screen / 30): Distance between the eyes.
---@field screen? number screen (a number, > 0; default focus): Distance along the view where both eyes, or all views of a light field, see the same point of the picture.
---@field rows? integer rows (a whole number, 1 to 1024; default 9 of gr.light_field): Rows of a light field: a grid of views, each of width x height pixels, in one file.
---@field columns? integer columns (a whole number, 1 to 1024; default 9 of gr.light_field): Its columns.
---@field size? number|number[] size (a number or a table of 2 numbers, 1 to 1048576, in pixels; default width, height): Both in one table: {width, height}; a number alone is a square.
---@field spacing? number spacing (a number, >= 0; default screen / 100): Distance between neighbouring cameras of a light field.
---@field depth? boolean depth (true or false; default false): Whether a light field keeps the depths of its pixels.
---@field shutter? number[] shutter (a table of two rising numbers; default {0, 1}): Times when the shutter opens and closes, {open, close}; motion between them is blurred.
---@field eye_to? gr.triple eye_to (a point {x, y, z}; default eye): Position of a moving camera at time 1.
---@field view_to? gr.triple view_to (a direction {x, y, z}; default view): Its direction of view at time 1.
---@field target_to? gr.triple target_to (a point {x, y, z}; default target): The point to look at, at time 1.
---@field up_to? gr.triple up_to (a direction {x, y, z}; default up): Its up direction at time 1.
---@field model? gr.node model (a node; default node): What -o MODEL writes and --check-print checks, without the ground of the picture.

---The same as gr.render with this node.
---@param file string file (the name of a file; default SCRIPT.png): Picture file: .png, for linear light .pfm .hdr .exr .lf; gray creates missing folders.
---@param width integer width (a whole number, 1 to 1048576, in pixels; default 960): Width of the picture.
---@param height integer height (a whole number, 1 to 1048576, in pixels; default 9/16 of width): Height of the picture.
---@param eye gr.triple eye (a point {x, y, z}; default fits the scene): Position of the camera.
---@param view gr.triple view (a direction {x, y, z}; default {0, 0, -1}): Direction of view.
---@param up gr.triple up (a direction {x, y, z}; default {0, 1, 0}): Direction that is up in the picture.
---@param fov number fov (a number, > 0 and < 180, in degrees; default 50): Full vertical angle of view.
---@param ambient? gr.triple|string ambient (a colour {r, g, b}; default {0, 0, 0}): Ambient light.
---@param lights? gr.light[] lights (a table of lights; default {}): The lights.
---@param fields? gr.node.render.fields Fields that are no arguments before it
---@overload fun(self: gr.node, fields: gr.node.render.fields)
function node:render(file, width, height, eye, view, up, fov, ambient, lights, fields) end

---@class gr.node.export.fields
---@field file string file (the name of a file): Model file: .stl .obj .ply .gltf .glb .3mf.
---@field tolerance? number tolerance (a number, > 0; default 1/1000 of the size): Largest distance of the model from the exact surface.
---@field unit? 'mm'|'cm'|'m'|'in' unit ('mm'|'cm'|'m'|'in'; default 'mm'): Unit of the numbers, for files that name it (3MF).
---@field text? boolean text (true or false; default false): Whether an STL file is text, not binary.

---Writes the solids of the node as a closed mesh, or as glTF the whole node, for printers and other programs.
---@param file string file (the name of a file): Model file: .stl .obj .ply .gltf .glb .3mf.
---@param fields? gr.node.export.fields Fields that are no arguments before it
---@overload fun(self: gr.node, fields: gr.node.export.fields)
function node:export(file, fields) end

---@class gr.frames.fields
---@field count? integer count (a whole number, >= 1; optional): Number of frames; give either count or seconds.
---@field draw function draw (a function): draw(t, frame) returns the table of fields for gr.render; t is from 0 to 1, frame from 1.
---@field seconds? number seconds (a number, > 0, in seconds; optional): Duration: seconds times fps is the number of frames, rounded.
---@field fps? number fps (a number, 0.01 to 1000; default 30): Frames per second; --fps has priority.
---@field loop? boolean loop (true or false; default false): After the last frame comes the first: t stays below 1, and players repeat the file without end.
---@field shutter? number[] shutter (a table of two rising numbers, in frames; default {0, 0}): When the shutter opens and closes; {0, 0.5} is half the time of a frame, 180 degrees.
---@field pure? boolean pure (true or false; default false): draw depends only on its arguments, so it is called only for rendered frames.

---Renders an animation: calls draw for each frame, and renders what it returns.
---@param count integer count (a whole number, >= 1; optional): Number of frames; give either count or seconds.
---@param draw function draw (a function): draw(t, frame) returns the table of fields for gr.render; t is from 0 to 1, frame from 1.
---@overload fun(fields: gr.frames.fields)
function gr.frames(count, draw) end

---A vector: a table {x, y, z} with operators. One number becomes all three components.
---@return gr.vector
function gr.vec(x, y, z) end

---The scalar product of two vectors.
---@return number
function gr.dot(a, b) end

---The vector product of two vectors.
---@return gr.vector
function gr.cross(a, b) end

---The length of a vector.
---@return number
function gr.length(v) end

---The vector divided by its length.
---@return gr.vector
function gr.normalize(v) end

---a + (b - a) * t, of numbers or vectors.
---@return any
function gr.mix(a, b, t) end

---x clamped to low..high; vectors by components.
---@return any
function gr.clamp(x, low, high) end

---0 below low, 1 above high, smooth between them.
---@return any
function gr.smoothstep(low, high, x) end

---0 where x < edge, else 1.
---@return any
function gr.step(edge, x) end

---The minimum of numbers or vectors, by components.
---@return any
function gr.min(...) end

---The maximum of numbers or vectors, by components.
---@return any
function gr.max(...) end

---a where x > 0, else b: a choice without a branch.
---@return any
function gr.where(x, a, b) end

---Entry i of a table of numbers or vectors; i is rounded down and clamped to 1..#t.
---@return any
function gr.lookup(t, i) end

---Replaces the state s1, s2, ... by f(i, s1, s2, ...) for i = 1 to n while s1 > 0; f is last.
---@return any ...
function gr.loop(n, ...) end

---Perlin noise at a point, or at x, y, z: about -1..1.
---@return number
function gr.noise(p) end

---The sum of |noise(2^k p)| / 2^k for octaves (4) values of k from 0 on.
---@return number
function gr.turbulence(p, octaves) end

---Distances to the nearest and the second nearest of random points, and a number in 0..1 that identifies the nearest.
---@return number
---@return number
---@return number
function gr.cells(p) end

---A random number in 0..1 for each point.
---@return number
function gr.hash(p) end

---A display colour: '#rrggbb', {r, g, b} or r, g, b; gray decodes it for linear colours.
---@return gr.triple
function gr.srgb(colour) end

---The light of a display colour as a vector, decoded by the sRGB function.
---@return gr.vector
function gr.linear(colour) end

---A function of seconds (gr.time) that interpolates keys {seconds, value}; fields: curve = 'linear', 'catmull' or 'bezier', and ease.
---@return fun(seconds?: number): any
function gr.keys(keys) end

---Whether x is a number of a recorded function, whose value is not known yet.
---@return boolean
function gr.is_recorded(x) end

