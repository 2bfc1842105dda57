---@meta

-- The gr functions for editors that understand LuaLS annotations. Written by `gray --annotations` from
-- the table in src/script/table.c; a test checks that it is current.

---@alias gr.triple number[] three numbers: a point, a direction, a colour
---@class gr.material
---@class gr.light
---@class gr.texture
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
---@field file? string file (the name of a file; optional): A Wavefront OBJ file, instead of verts and faces.
---@field verts? gr.triple[] verts (a table of points {x, y, z}; optional): The vertices.
---@field normals? gr.triple[] normals (a table of points {x, y, z}; default none: flat): Vertex normals, of any length.
---@field faces? integer[][] faces (a table of tuples of indices; optional): Polygons: tuples of 0-based indices into verts.
---@field face_normals? integer[][] face_normals (a table of tuples of indices; default faces): For each face a tuple of 0-based indices into normals.
---@field uvs? number[][] uvs (a table of pairs {u, v}; default none): Places on an image, {u, v}; v counts from below.
---@field face_uvs? integer[][] face_uvs (a table of tuples of indices; default faces): For each face a tuple of 0-based indices into uvs.

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
---@field file? string file (the name of a file; optional): A Wavefront OBJ file, instead of verts and faces.
---@field verts? gr.triple[] verts (a table of points {x, y, z}; optional): The vertices.
---@field normals? gr.triple[] normals (a table of points {x, y, z}; default none: flat): Vertex normals, of any length.
---@field faces? integer[][] faces (a table of tuples of indices; optional): Polygons: tuples of 0-based indices into verts.
---@field face_normals? integer[][] face_normals (a table of tuples of indices; default faces): For each face a tuple of 0-based indices into normals.
---@field uvs? number[][] uvs (a table of pairs {u, v}; default none): Places on an image, {u, v}; v counts from below.
---@field face_uvs? integer[][] face_uvs (a table of tuples of indices; default faces): For each face a tuple of 0-based indices into uvs.

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
---@field file? string file (the name of a file; optional): A Wavefront OBJ file, instead of verts and faces.
---@field verts? gr.triple[] verts (a table of points {x, y, z}; optional): The vertices.
---@field normals? gr.triple[] normals (a table of points {x, y, z}; default none: flat): Vertex normals, of any length.
---@field faces? integer[][] faces (a table of tuples of indices; optional): Polygons: tuples of 0-based indices into verts.
---@field face_normals? integer[][] face_normals (a table of tuples of indices; default faces): For each face a tuple of 0-based indices into normals.
---@field uvs? number[][] uvs (a table of pairs {u, v}; default none): Places on an image, {u, v}; v counts from below.
---@field face_uvs? integer[][] face_uvs (a table of tuples of indices; default faces): For each face a tuple of 0-based indices into uvs.

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
---@field file? string file (the name of a file; optional): A Wavefront OBJ file, instead of verts and faces.
---@field verts? gr.triple[] verts (a table of points {x, y, z}; optional): The vertices.
---@field normals? gr.triple[] normals (a table of points {x, y, z}; default none: flat): Vertex normals, of any length.
---@field faces? integer[][] faces (a table of tuples of indices; optional): Polygons: tuples of 0-based indices into verts.
---@field face_normals? integer[][] face_normals (a table of tuples of indices; default faces): For each face a tuple of 0-based indices into normals.
---@field uvs? number[][] uvs (a table of pairs {u, v}; default none): Places on an image, {u, v}; v counts from below.
---@field face_uvs? integer[][] face_uvs (a table of tuples of indices; default faces): For each face a tuple of 0-based indices into uvs.

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

---The solid of what is in a or in b.
---@param name string name (a string; default 'csg'): Name of the node, for messages.
---@param a gr.node a (a node): A closed solid; a group counts as the union of what is under it.
---@param b gr.node b (a node): The other one.
---@return gr.node
---@overload fun(fields: gr.csg_union.fields): gr.node
function gr.csg_union(name, a, b) end

---@class gr.csg_difference.fields
---@field name? string name (a string; default 'csg'): Name of the node, for messages.
---@field a gr.node a (a node): A closed solid; a group counts as the union of what is under it.
---@field b gr.node b (a node): The other one.

---The solid of what is in a and not in b.
---@param name string name (a string; default 'csg'): Name of the node, for messages.
---@param a gr.node a (a node): A closed solid; a group counts as the union of what is under it.
---@param b gr.node b (a node): The other one.
---@return gr.node
---@overload fun(fields: gr.csg_difference.fields): gr.node
function gr.csg_difference(name, a, b) end

---@class gr.csg_intersection.fields
---@field name? string name (a string; default 'csg'): Name of the node, for messages.
---@field a gr.node a (a node): A closed solid; a group counts as the union of what is under it.
---@field b gr.node b (a node): The other one.

---The solid of what is in a and in b.
---@param name string name (a string; default 'csg'): Name of the node, for messages.
---@param a gr.node a (a node): A closed solid; a group counts as the union of what is under it.
---@param b gr.node b (a node): The other one.
---@return gr.node
---@overload fun(fields: gr.csg_intersection.fields): gr.node
function gr.csg_intersection(name, a, b) end

---@class gr.union.fields
---@field name? string name (a string; default 'csg'): Name of the node, for messages.
---@field a gr.node a (a node): A closed solid; a group counts as the union of what is under it.
---@field b gr.node b (a node): The other one.

---The same as gr.csg_union.
---@param name string name (a string; default 'csg'): Name of the node, for messages.
---@param a gr.node a (a node): A closed solid; a group counts as the union of what is under it.
---@param b gr.node b (a node): The other one.
---@return gr.node
---@overload fun(fields: gr.union.fields): gr.node
function gr.union(name, a, b) end

---@class gr.difference.fields
---@field name? string name (a string; default 'csg'): Name of the node, for messages.
---@field a gr.node a (a node): A closed solid; a group counts as the union of what is under it.
---@field b gr.node b (a node): The other one.

---The same as gr.csg_difference.
---@param name string name (a string; default 'csg'): Name of the node, for messages.
---@param a gr.node a (a node): A closed solid; a group counts as the union of what is under it.
---@param b gr.node b (a node): The other one.
---@return gr.node
---@overload fun(fields: gr.difference.fields): gr.node
function gr.difference(name, a, b) end

---@class gr.intersection.fields
---@field name? string name (a string; default 'csg'): Name of the node, for messages.
---@field a gr.node a (a node): A closed solid; a group counts as the union of what is under it.
---@field b gr.node b (a node): The other one.

---The same as gr.csg_intersection.
---@param name string name (a string; default 'csg'): Name of the node, for messages.
---@param a gr.node a (a node): A closed solid; a group counts as the union of what is under it.
---@param b gr.node b (a node): The other one.
---@return gr.node
---@overload fun(fields: gr.intersection.fields): gr.node
function gr.intersection(name, a, b) end

---A capped cylinder around y, radius 1, y from -1 to 1. Comes with version 0.2.
---@param name? string name (a string; optional): Name of the node, for messages.
---@return gr.node
function gr.cylinder(name) end

---A cone, apex at the origin, base of radius 1 at y = 1. Comes with version 0.2.
---@param name? string name (a string; optional): Name of the node, for messages.
---@return gr.node
function gr.cone(name) end

---A torus around y. Comes with version 0.2.
---@param name? string name (a string; optional): Name of the node, for messages.
---@return gr.node
function gr.torus(name) end

---The square from -0.5 to 0.5 in x and z at y = 0. Comes with version 0.2.
---@param name? string name (a string; optional): Name of the node, for messages.
---@return gr.node
function gr.plane(name) end

---@class gr.material.fields
---@field kd gr.triple kd (a colour {r, g, b}): Colour of diffuse and ambient light.
---@field ks? gr.triple ks (a colour {r, g, b}; default {0, 0, 0}): Colour of highlights, filter of secondary rays.
---@field shininess? number shininess (a number, >= 0; default 1): Exponent of the highlight.
---@field reflect? number reflect (a number, 0 to 1; default 0): Amount of reflected light.
---@field refract? number refract (a number, 0 to 1; default 0): Amount of refracted light.
---@field ior? number ior (a number, >= 1; default none): Index of refraction of the inside.
---@field two_sided? boolean two_sided (true or false; default false): Whether faces seen from behind are lit as well.

---A Phong material.
---@param kd gr.triple kd (a colour {r, g, b}): Colour of diffuse and ambient light.
---@param ks gr.triple ks (a colour {r, g, b}; default {0, 0, 0}): Colour of highlights, filter of secondary rays.
---@param shininess number shininess (a number, >= 0; default 1): Exponent of the highlight.
---@return gr.material
---@overload fun(fields: gr.material.fields): gr.material
function gr.material(kd, ks, shininess) end

---@class gr.rr_material.fields
---@field kd gr.triple kd (a colour {r, g, b}): Colour of diffuse and ambient light.
---@field ks? gr.triple ks (a colour {r, g, b}; default {0, 0, 0}): Colour of highlights, filter of secondary rays.
---@field shininess? number shininess (a number, >= 0; default 1): Exponent of the highlight.
---@field reflect? number reflect (a number, 0 to 1; default 0): Amount of reflected light.
---@field refract? number refract (a number, 0 to 1; default 0): Amount of refracted light.
---@field ior? number ior (a number, >= 1; default 1): Index of refraction of the inside.
---@field two_sided? boolean two_sided (true or false; default false): Whether faces seen from behind are lit as well.

---A Phong material that reflects and refracts.
---@param kd gr.triple kd (a colour {r, g, b}): Colour of diffuse and ambient light.
---@param ks gr.triple ks (a colour {r, g, b}; default {0, 0, 0}): Colour of highlights, filter of secondary rays.
---@param shininess number shininess (a number, >= 0; default 1): Exponent of the highlight.
---@param reflect number reflect (a number, 0 to 1; default 0): Amount of reflected light.
---@param refract number refract (a number, 0 to 1; default 0): Amount of refracted light.
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
---@field png string|gr.texture png (the name of a PNG file or a texture): A PNG file, or a texture.
---@field filter? 'nearest'|'bilinear'|'mipmap' filter ('nearest'|'bilinear'|'mipmap'; default 'mipmap'): How the image is looked up.
---@field flip_u? boolean flip_u (true or false; default false): Whether left and right are exchanged.

---An image on each side of the unit cube, over another material.
---@param material gr.material material (a material): The material below.
---@param png string|gr.texture png (the name of a PNG file or a texture): A PNG file, or a texture.
---@return gr.material
---@overload fun(fields: gr.td_cube_material.fields): gr.material
function gr.td_cube_material(material, png) end

---@class gr.td_sphere_material.fields
---@field material gr.material material (a material): The material below.
---@field png string|gr.texture png (the name of a PNG file or a texture): A PNG file, or a texture.
---@field filter? 'nearest'|'bilinear'|'mipmap' filter ('nearest'|'bilinear'|'mipmap'; default 'mipmap'): How the image is looked up.
---@field flip_u? boolean flip_u (true or false; default false): Whether left and right are exchanged.

---An image around the unit sphere, over another material.
---@param material gr.material material (a material): The material below.
---@param png string|gr.texture png (the name of a PNG file or a texture): A PNG file, or a texture.
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
---@field file string|gr.texture file (the name of a PNG file or a texture): A PNG file.
---@field filter? 'nearest'|'bilinear'|'mipmap' filter ('nearest'|'bilinear'|'mipmap'; default 'mipmap'): How the image is looked up.
---@field wrap? 'clamp'|'repeat'|'mirror' wrap ('clamp'|'repeat'|'mirror'; default 'repeat'): What is beyond its edges, on meshes.
---@field flip_u? boolean flip_u (true or false; default false): Whether left and right are exchanged.

---An image for node:set_texture.
---@param file string|gr.texture file (the name of a PNG file or a texture): A PNG file.
---@return gr.texture
---@overload fun(fields: gr.texture.fields): gr.texture
function gr.texture(file) end

---A bump map for node:set_bump. Comes with version 0.2.
---@param name? string name (a string; optional): Name of the node, for messages.
---@return gr.texture
function gr.bump(name) end

---@class gr.light.fields
---@field position gr.triple position (a point {x, y, z}): Where it stands.
---@field colour gr.triple colour (a colour {r, g, b}): Its colour and strength.
---@field falloff? gr.triple falloff (a table of 3 numbers; default {1, 0, 0}): Coefficients: light is divided by c0 + c1 d + c2 d^2.

---A light at a point.
---@param position gr.triple position (a point {x, y, z}): Where it stands.
---@param colour gr.triple colour (a colour {r, g, b}): Its colour and strength.
---@param falloff? gr.triple falloff (a table of 3 numbers; default {1, 0, 0}): Coefficients: light is divided by c0 + c1 d + c2 d^2.
---@return gr.light
---@overload fun(fields: gr.light.fields): gr.light
function gr.light(position, colour, falloff) end

---@class gr.area_light.fields
---@field corner gr.triple corner (a point {x, y, z}): One corner of the parallelogram.
---@field v1 gr.triple v1 (a direction {x, y, z}): The edge to the next corner.
---@field v2 gr.triple v2 (a direction {x, y, z}): The edge to the corner on the other side.
---@field colour gr.triple colour (a colour {r, g, b}): Its colour and strength.
---@field falloff? gr.triple falloff (a table of 3 numbers; default {1, 0, 0}): Coefficients: light is divided by c0 + c1 d + c2 d^2.

---A light that is a parallelogram; soft shadows.
---@param corner gr.triple corner (a point {x, y, z}): One corner of the parallelogram.
---@param v1 gr.triple v1 (a direction {x, y, z}): The edge to the next corner.
---@param v2 gr.triple v2 (a direction {x, y, z}): The edge to the corner on the other side.
---@param colour gr.triple colour (a colour {r, g, b}): Its colour and strength.
---@param falloff? gr.triple falloff (a table of 3 numbers; default {1, 0, 0}): Coefficients: light is divided by c0 + c1 d + c2 d^2.
---@return gr.light
---@overload fun(fields: gr.area_light.fields): gr.light
function gr.area_light(corner, v1, v2, colour, falloff) end

---A light that is a sphere. Comes with version 0.2.
---@param name? string name (a string; optional): Name of the node, for messages.
---@return gr.light
function gr.spherical_light(name) end

---@class gr.render.fields
---@field node gr.node node (a node): The root of what is drawn.
---@field file string file (the name of a file): The PNG file to write; missing folders are made.
---@field sky? string|gr.texture sky (the name of a PNG file or a texture; optional): A 4 x 3 cross of images all around, as a PNG file.
---@field width integer width (a whole number, 1 to 1048576, in pixels): Width of the picture.
---@field height integer height (a whole number, 1 to 1048576, in pixels): Height of the picture.
---@field eye gr.triple eye (a point {x, y, z}): Where the camera stands.
---@field view? gr.triple view (a direction {x, y, z}; default {0, 0, -1}): The direction it looks in.
---@field up? gr.triple up (a direction {x, y, z}; default {0, 1, 0}): The direction that is up in the picture.
---@field fov? number fov (a number, > 0 and < 180, in degrees; default 50): The full vertical angle of view.
---@field ambient? gr.triple ambient (a colour {r, g, b}; default {0, 0, 0}): Light that is everywhere.
---@field lights? gr.light[] lights (a table of lights; default {}): A table of lights.
---@field target? gr.triple target (a point {x, y, z}; optional): A point to look at, instead of view.
---@field background? gr.triple|'gradient' background (a colour {r, g, b} or 'gradient'; default 'gradient'): What rays see that meet nothing: a colour, or 'gradient' for {0, 0, (1 + y)/2}.
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
---@field accel? 'grid'|'none' accel ('grid'|'none'; default 'grid'): How hits are searched; the picture is the same.

---Renders a picture into a PNG file.
---@param node gr.node node (a node): The root of what is drawn.
---@param file string file (the name of a file): The PNG file to write; missing folders are made.
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
---@field file string file (the name of a file): The PNG file to write; missing folders are made.
---@field sky? string|gr.texture sky (the name of a PNG file or a texture; optional): A 4 x 3 cross of images all around, as a PNG file.
---@field width integer width (a whole number, 1 to 1048576, in pixels): Width of the picture.
---@field height integer height (a whole number, 1 to 1048576, in pixels): Height of the picture.
---@field eye gr.triple eye (a point {x, y, z}): Where the camera stands.
---@field view? gr.triple view (a direction {x, y, z}; default {0, 0, -1}): The direction it looks in.
---@field up? gr.triple up (a direction {x, y, z}; default {0, 1, 0}): The direction that is up in the picture.
---@field fov? number fov (a number, > 0 and < 180, in degrees; default 50): The full vertical angle of view.
---@field ambient? gr.triple ambient (a colour {r, g, b}; default {0, 0, 0}): Light that is everywhere.
---@field lights? gr.light[] lights (a table of lights; default {}): A table of lights.
---@field target? gr.triple target (a point {x, y, z}; optional): A point to look at, instead of view.
---@field background? gr.triple|'gradient' background (a colour {r, g, b} or 'gradient'; default 'gradient'): What rays see that meet nothing: a colour, or 'gradient' for {0, 0, (1 + y)/2}.
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
---@field accel? 'grid'|'none' accel ('grid'|'none'; default 'grid'): How hits are searched; the picture is the same.

---The same with a sky image all around.
---@param node gr.node node (a node): The root of what is drawn.
---@param file string file (the name of a file): The PNG file to write; missing folders are made.
---@param sky string|gr.texture sky (the name of a PNG file or a texture; optional): A 4 x 3 cross of images all around, as a PNG file.
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

---Gives a shape its material.
---@param material gr.material material (a material): What its surface looks like.
---@return gr.node
function node:set_material(material) end

---Puts an image in the place of kd.
---@param texture string|gr.texture texture (the name of a PNG file or a texture): A texture, or the name of a PNG file.
---@return gr.node
function node:set_texture(texture) end

---Puts a bump map on a shape. Comes with version 0.2.
---@param name? string name (a string; optional): Name of the node, for messages.
---@return gr.node
function node:set_bump(name) end

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

---Moves this node.
---@param x number x (a number): How far along x.
---@param y number y (a number): How far along y.
---@param z number z (a number): How far along z.
---@return gr.node
---@overload fun(self: gr.node, vector: gr.triple): gr.node
function node:translate(x, y, z) end

---The same as gr.render with this node.
---@param file string file (the name of a file): The PNG file to write; missing folders are made.
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

