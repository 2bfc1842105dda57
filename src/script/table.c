/* The table of gr functions. One row for each function; its documentation and every check of its arguments come from
 * here. The rows of shapes and lights are in the files that make them. docs/language.md describes all of them. */
#include "script/table_internal.h"

#include "call/display_colour.h"
#include "record/symbol.h"
#include "render/settings.h"
#include "scene/change.h"
#include "script/gr_keys_internal.h"
#include "script/table_rows_internal.h"

#include <string.h>

#define CHILDREN                                                                                                       \
    { "children", KIND_NODES, OPTIONAL, ANY, NULL, "{}", "Child nodes." }

static const struct script_parameter group_parameters[] = {
    [GROUP_NAME] = {"name", KIND_TEXT, OPTIONAL, ANY, NULL, "'node'", NAME_HELP},
    [GROUP_CHILDREN] = CHILDREN,
};

static const struct script_parameter instances_parameters[] = {
    [INSTANCES_NAME] = {"name", KIND_TEXT, OPTIONAL, ANY, NULL, "'instances'", NAME_HELP},
    [INSTANCES_OF] = {"of", KIND_NODE, 0, ANY, NULL, NULL, "The node to place."},
    [INSTANCES_AT] = {"at", KIND_ROWS, 0, ANY, NULL, NULL,
                      "Its positions, {x, y, z}, or matrices of three rows, 12 numbers each."},
    [INSTANCES_TURN] =
        {"turn", KIND_NUMBERS, OPTIONAL, ANY, "degrees", "0",
         "Angle of a rotation about axis, before the translation; one for each position, or one for all."},
    [INSTANCES_AXIS] = {"axis", KIND_AXIS, OPTIONAL, 0, 0, "x y z", NULL, "'y'", "Axis of that rotation."},
    [INSTANCES_SIZE] = {"size", KIND_NUMBERS, OPTIONAL | LOW_OPEN, ABOVE(0), NULL, "1",
                        "Scale factor, applied first; one for each position, or one for all."},
};

static const struct script_parameter joint_parameters[] = {
    [JOINT_NAME] = {"name", KIND_TEXT, OPTIONAL, ANY, NULL, "'joint'", NAME_HELP},
    [JOINT_X] = {"x", KIND_TRIPLE, 0, ANY, "degrees", NULL,
                 "Smallest, initial and largest angle about x; gray draws the initial one."},
    [JOINT_Y] = {"y", KIND_TRIPLE, 0, ANY, "degrees", NULL, "The same for y."},
    [JOINT_CHILDREN] = CHILDREN,
};

static const struct script_parameter sphere_parameters[] = {
    [SPHERE_NAME] = {"name", KIND_TEXT, OPTIONAL, ANY, NULL, "'sphere'", NAME_HELP},
    [SPHERE_MATERIAL] = {"material", KIND_MATERIAL, OPTIONAL | GHOST_IS_NONE, ANY, NULL, "plain gray", MATERIAL_HELP},
    [SPHERE_CENTRE] = {"centre", KIND_POINT, OPTIONAL, ANY, NULL, "{0, 0, 0}", "Centre."},
    [SPHERE_RADIUS] = {"radius", KIND_NUMBER, OPTIONAL | LOW_OPEN, ABOVE(0), NULL, "1", "Radius."},
};

static const struct script_parameter cube_parameters[] = {
    [CUBE_NAME] = {"name", KIND_TEXT, OPTIONAL, ANY, NULL, "'cube'", NAME_HELP},
    [CUBE_MATERIAL] = {"material", KIND_MATERIAL, OPTIONAL | GHOST_IS_NONE, ANY, NULL, "plain gray", MATERIAL_HELP},
    [CUBE_CORNER] = {"corner", KIND_POINT, OPTIONAL, ANY, NULL, "{0, 0, 0}",
                     "The corner with the smallest coordinates."},
    [CUBE_SIZE] = {"size", KIND_SIZE, OPTIONAL | NOT_ZERO, ANY, NULL, "1",
                   "Length of the edges, one number or three; a negative length extends in the negative direction."},
};

static const struct script_parameter mesh_parameters[] = {
    [MESH_NAME] = {"name", KIND_TEXT, OPTIONAL, ANY, NULL, "'mesh'", NAME_HELP},
    [MESH_MATERIAL] = {"material", KIND_MATERIAL, OPTIONAL | GHOST_IS_NONE, ANY, NULL, "plain gray", MATERIAL_HELP},
    [MESH_FILE] = {"file", KIND_FILE, OPTIONAL, ANY, NULL, NULL,
                   "An OBJ, PLY, STL, glTF or GLB file, instead of verts and faces."},
    [MESH_VERTS] = {"verts", KIND_POINTS, OPTIONAL, ANY, NULL, NULL, "The vertices."},
    [MESH_NORMALS] = {"normals", KIND_POINTS, OPTIONAL, ANY, NULL, "none: flat", "Vertex normals, of any length."},
    [MESH_FACES] = {"faces", KIND_FACES, OPTIONAL, ANY, NULL, NULL, "Polygons: tuples of indices into verts, from 0."},
    [MESH_FACE_NORMALS] = {"face_normals", KIND_FACES, OPTIONAL, ANY, NULL, "faces",
                           "For each face a tuple of indices into normals, from 0."},
    [MESH_UVS] = {"uvs", KIND_PAIRS, OPTIONAL, ANY, NULL, "none",
                  "Texture coordinates, {u, v}; v = 0 is the lower edge of an image."},
    [MESH_FACE_UVS] = {"face_uvs", KIND_FACES, OPTIONAL, ANY, NULL, "faces",
                       "For each face a tuple of indices into uvs, from 0."},
    [MESH_SMOOTH] =
        {"smooth", KIND_NUMBER, OPTIONAL, IN_RANGE(0, 180), "degrees", "the given normals",
         "Crease angle: faces that meet at a smaller angle are shaded as one smooth surface; 0: all faces are flat."},
    [MESH_WELD] = {"weld", KIND_BOOLEAN, OPTIONAL, ANY, NULL, "false",
                   "Whether vertices at the same position become one."},
    [MESH_FLIP] = {"flip", KIND_BOOLEAN, OPTIONAL, ANY, NULL, "false", "Whether the faces are reversed."},
    [MESH_CULL] = {"cull", KIND_CHOICE, OPTIONAL, 0, 0, LIST_BLANKS(NODE_CULLS), NULL, "'none'",
                   "Which faces rays ignore: those seen from behind, or those seen from the front."},
    [MESH_MATERIALS] = {"materials", KIND_MATERIALS, OPTIONAL, ANY, NULL, "the file's",
                        "Materials by the names of the parts in the file; with face_materials, a list."},
    [MESH_FACE_MATERIALS] = {"face_materials", KIND_NUMBERS, OPTIONAL, ANY, NULL, "material for all",
                             "With faces: the index into materials of each face, from 1."},
};

#define SERIAL_HELP "Its number in order of creation, from 0; nodes added in the window count down from 4294967295."
#define CHANGED_NAME "Name of the node; gray ignores a node with another name."
#define SERIALS IN_RANGE(0, 4294967295.0)
#define PICTURE_HELP "The file name that gr.render has for the picture."

static const struct script_parameter change_node_parameters[] = {
    [CHANGENODE_NAME] = {"name", KIND_TEXT, 0, ANY, NULL, NULL, CHANGED_NAME},
    [CHANGENODE_SERIAL] = {"serial", KIND_WHOLE, 0, SERIALS, NULL, NULL, SERIAL_HELP},
    [CHANGENODE_MATRIX] =
        {"matrix", KIND_NUMBERS, 0, ANY, NULL, NULL,
         "Three rows of a matrix, 12 numbers, applied after its own transforms, in the space of its parent."},
};

static const struct script_parameter change_delete_parameters[] = {
    [CHANGEGONE_NAME] = {"name", KIND_TEXT, 0, ANY, NULL, NULL, CHANGED_NAME},
    [CHANGEGONE_SERIAL] = {"serial", KIND_WHOLE, 0, SERIALS, NULL, NULL, SERIAL_HELP},
};

static const struct script_parameter change_add_parameters[] = {
    [CHANGEADD_NAME] = {"name", KIND_TEXT, 0, ANY, NULL, NULL, "Name of the parent node."},
    [CHANGEADD_SERIAL] = {"serial", KIND_WHOLE, 0, SERIALS, NULL, NULL, SERIAL_HELP},
    [CHANGEADD_SHAPE] = {"shape", KIND_CHOICE, 0, 0, 0, LIST_BLANKS(ADDED), NULL, NULL,
                         "Shape of the new node, about the size of a unit sphere, or a copy of a node."},
    [CHANGEADD_COLOUR] = {"colour", KIND_COLOUR, OPTIONAL, ANY, NULL, "{0.7, 0.7, 0.7}", "Its colour."},
    [CHANGEADD_SOURCE] = {"source", KIND_WHOLE, OPTIONAL, SERIALS, NULL, "0",
                          "For a copy: the number of the node to copy."},
};

static const struct script_parameter change_material_parameters[] = {
    [CHANGEMATERIAL_SERIAL] = {"serial", KIND_WHOLE, 0, SERIALS, NULL, NULL,
                               "Number of the material in order of creation, from 1."},
    [CHANGEMATERIAL_COLOUR] = {"colour", KIND_COLOUR, 0, ANY, NULL, NULL, "New kd of its base material."},
};

static const struct script_parameter change_look_parameters[] = {
    [CHANGELOOK_SERIAL] = {"serial", KIND_WHOLE, 0, SERIALS, NULL, NULL,
                           "Number of the material in order of creation, from 1."},
    [CHANGELOOK_PART] = {"part", KIND_CHOICE, 0, 0, 0, LIST_BLANKS(MATERIAL_PART_LIST), NULL, NULL,
                         "Argument of gr.material to change in its base material."},
    [CHANGELOOK_VALUE] = {"value", KIND_NUMBERS, 0, ANY, NULL, NULL,
                          "New value: three numbers for a colour, else one."},
};

static const struct script_parameter change_own_parameters[] = {
    [CHANGEOWN_NAME] = {"name", KIND_TEXT, 0, ANY, NULL, NULL, CHANGED_NAME},
    [CHANGEOWN_SERIAL] = {"serial", KIND_WHOLE, 0, SERIALS, NULL, NULL, SERIAL_HELP},
    [CHANGEOWN_LIKE] = {"like", KIND_WHOLE, OPTIONAL, SERIALS, NULL, "0",
                        "For a shape without a material: number of the material to copy; 0: plain gray."},
};

static const struct script_parameter change_light_parameters[] = {
    [CHANGELIGHT_NUMBER] = {"number", KIND_WHOLE, 0, 1, 4294967295.0, NULL, NULL, NULL,
                            "Index in the list of lights of gr.render, from 1."},
    [CHANGELIGHT_MOVE] = {"move", KIND_TRIPLE, 0, ANY, NULL, NULL, "Translation."},
    [CHANGELIGHT_FACTOR] = {"factor", KIND_TRIPLE, OPTIONAL, ANY, NULL, "{1, 1, 1}", "Factor of its colour."},
    [CHANGELIGHT_TURN] = {"linear", KIND_NUMBERS, OPTIONAL, ANY, NULL, "none",
                          "Three rows of a matrix, 9 numbers: rotation and scale about its position."},
    [CHANGELIGHT_COLOUR] = {"colour", KIND_COLOUR, OPTIONAL, ANY, NULL, "its own", "New colour, before the factor."},
};

static const struct script_parameter change_delete_light_parameters[] = {
    [CHANGEDARK_NUMBER] = {"number", KIND_WHOLE, 0, 1, 4294967295.0, NULL, NULL, NULL,
                           "Index in the list of lights of gr.render, from 1."},
};

static const struct script_parameter change_add_light_parameters[] = {
    [CHANGENEWLIGHT_POSITION] = {"position", KIND_POINT, 0, ANY, NULL, NULL, "Where it is."},
    [CHANGENEWLIGHT_COLOUR] = {"colour", KIND_COLOUR, 0, ANY, NULL, NULL, "Its colour."},
};

static const struct script_parameter change_copy_light_parameters[] = {
    [CHANGECOPYLIGHT_NUMBER] = {"number", KIND_WHOLE, 0, 1, 4294967295.0, NULL, NULL, NULL,
                                "Index in the list of lights of gr.render, from 1."},
    [CHANGECOPYLIGHT_MOVE] = {"move", KIND_TRIPLE, 0, ANY, NULL, NULL, "Translation of the copy."},
    [CHANGECOPYLIGHT_FACTOR] = {"factor", KIND_TRIPLE, OPTIONAL, ANY, NULL, "{1, 1, 1}",
                                "Factor of the colour of the copy."},
};

static const struct script_parameter change_view_parameters[] = {
    [CHANGEVIEW_PICTURE] = {"picture", KIND_TEXT, 0, ANY, NULL, NULL, PICTURE_HELP},
    [CHANGEVIEW_EYE] = {"eye", KIND_POINT, 0, ANY, NULL, NULL, "Position of the camera."},
    [CHANGEVIEW_VIEW] = {"view", KIND_DIRECTION, 0, ANY, NULL, NULL, "Direction of view."},
    [CHANGEVIEW_UP] = {"up", KIND_DIRECTION, 0, ANY, NULL, NULL, "Direction that is up in the picture."},
    [CHANGEVIEW_FOV] = {"fov", KIND_NUMBER, LOW_OPEN | HIGH_OPEN, IN_RANGE(0, 180), "degrees", NULL,
                        "Full vertical angle of view."},
};

static const struct script_parameter change_exposure_parameters[] = {
    [CHANGEEXPOSURE_PICTURE] = {"picture", KIND_TEXT, 0, ANY, NULL, NULL, PICTURE_HELP},
    [CHANGEEXPOSURE_STOPS] = {"stops", KIND_NUMBER, 0, IN_RANGE(-100, 100), "stops", NULL, "New exposure."},
};

static const struct script_parameter self_parameters[] = {{"self", KIND_NODE, 0, ANY, NULL, NULL, "The node."}};

static const struct script_parameter geometry_parameters[] = {
    [GEOMETRY_NAME] = {"name", KIND_TEXT, OPTIONAL, ANY, NULL, "'geometry'", NAME_HELP},
    [GEOMETRY_PRIMITIVE] = {"primitive", KIND_NODE, 0, ANY, NULL, NULL, "A primitive, for instance gr.sphere(mat)."},
    [GEOMETRY_MATERIAL] = {"material", KIND_MATERIAL, OPTIONAL | GHOST_IS_NONE, ANY, NULL, "the primitive's",
                           MATERIAL_HELP},
};

static const struct script_parameter csg_parameters[] = {
    [CSG_NAME] = {"name", KIND_TEXT, OPTIONAL, ANY, NULL, "'csg'", NAME_HELP},
    [CSG_A] = {"a", KIND_NODE, GHOST_IS_NONE, ANY, NULL, NULL,
               "A closed solid; a group is the union of the solids below it."},
    [CSG_B] = {"b", KIND_NODE, GHOST_IS_NONE, ANY, NULL, NULL, "The second operand."},
    [CSG_OPERANDS] = {"operands", KIND_NODES, OPTIONAL | REST, ANY, NULL, NULL,
                      "Further operands: as extra arguments, as this list, or as unnamed entries of the table; a and b "
                      "may be left out then."},
};

static const struct script_parameter inverse_parameters[] = {
    [INVERSE_NAME] = {"name", KIND_TEXT, OPTIONAL, ANY, NULL, "'inverse'", NAME_HELP},
    [INVERSE_A] = {"a", KIND_NODE, GHOST_IS_NONE, ANY, NULL, NULL,
                   "A closed solid; a group is the union of the solids below it."},
};

static const struct script_parameter clipped_parameters[] = {
    [CLIPPED_NAME] = {"name", KIND_TEXT, OPTIONAL, ANY, NULL, "'clipped'", NAME_HELP},
    [CLIPPED_OBJECT] = {"object", KIND_NODE, GHOST_IS_NONE, ANY, NULL, NULL,
                        "The visible object: a shape or a group of shapes."},
    [CLIPPED_BY] = {"by", KIND_NODE, GHOST_IS_NONE, ANY, NULL, NULL,
                    "A closed solid; the part of the object inside it remains."},
};

static const struct script_parameter bounded_parameters[] = {
    [CLIPPED_NAME] = {"name", KIND_TEXT, OPTIONAL, ANY, NULL, "'bounded'", NAME_HELP},
    [CLIPPED_OBJECT] = {"object", KIND_NODE, GHOST_IS_NONE, ANY, NULL, NULL,
                        "The visible object: a shape or a group of shapes."},
    [CLIPPED_BY] = {"by", KIND_NODE, GHOST_IS_NONE, ANY, NULL, NULL,
                    "A closed solid that contains the object. gray does not verify this: parts outside may or may not "
                    "be visible."},
};

static const struct script_parameter order_parameters[] = {
    {"order", KIND_CHOICE, 0, 0, 0, LIST_BLANKS(TRANSFORM_ORDERS), NULL, NULL,
     "new: calls act in the order in which they are written; old: the last call acts first; separate: scale, then "
     "rotate, then translate."},
};

#define SELF_PARAMETER [SELF] = {"self", KIND_NODE, 0, ANY, NULL, NULL, "The node."}

static const struct script_parameter child_parameters[] = {
    SELF_PARAMETER,
    [CHILD_NODE] = {"node", KIND_NODE, 0, ANY, NULL, NULL, "The child; a node under several parents is an instance."},
};

static const struct script_parameter set_material_parameters[] = {
    SELF_PARAMETER,
    [SET_MATERIAL] = {"material", KIND_MATERIAL, 0, ANY, NULL, NULL, MATERIAL_HELP},
};

static const struct script_parameter set_texture_parameters[] = {
    SELF_PARAMETER,
    [SET_TEXTURE] = {"texture", KIND_IMAGE, 0, ANY, NULL, NULL, "A texture, or the name of a PNG or JPEG file."},
};

static const struct script_parameter set_bump_parameters[] = {
    SELF_PARAMETER,
    [SET_BUMP] = {"bump", KIND_IMAGE, OR_TEXTURE, ANY, NULL, NULL,
                  "A result of gr.bump, or the name of a PNG or JPEG file."},
};

static const struct script_parameter translate_parameters[] = {
    SELF_PARAMETER,
    [STEP_X] = {"x", KIND_NUMBER, 0, ANY, NULL, NULL, "Distance along x."},
    [STEP_Y] = {"y", KIND_NUMBER, 0, ANY, NULL, NULL, "Distance along y."},
    [STEP_Z] = {"z", KIND_NUMBER, 0, ANY, NULL, NULL, "Distance along z."},
    [STEP_VECTOR] = {"vector", KIND_TRIPLE, 0, ANY, NULL, NULL, "The three numbers as a table."},
};

static const struct script_parameter velocity_parameters[] = {
    SELF_PARAMETER,
    [STEP_X] = {"x", KIND_NUMBER, 0, ANY, NULL, NULL, "Distance along x per second, in the space of the parent."},
    [STEP_Y] = {"y", KIND_NUMBER, 0, ANY, NULL, NULL, "Distance along y."},
    [STEP_Z] = {"z", KIND_NUMBER, 0, ANY, NULL, NULL, "Distance along z."},
    [STEP_VECTOR] = {"vector", KIND_TRIPLE, 0, ANY, NULL, NULL, "The three numbers as a table."},
};

static const struct script_parameter moves_to_parameters[] = {
    SELF_PARAMETER,
    [MOVES_TO_NODE] = {"node", KIND_NODE, 0, ANY, NULL, NULL,
                       "A node whose own transforms are the pose of this one at time 1; it need not be in the scene."},
};

static const struct script_parameter spin_parameters[] = {
    SELF_PARAMETER,
    [SPIN_AXIS] = {"axis", KIND_AXIS, 0, 0, 0, "x y z", NULL, NULL, "The axis."},
    [SPIN_DEGREES] = {"degrees", KIND_NUMBER, 0, ANY, "degrees", NULL, "Angle per second; 0: none."},
    [SPIN_DIRECTION] = {"direction", KIND_DIRECTION, 0, ANY, NULL, NULL, "Any direction as axis."},
};

static const struct script_parameter scale_parameters[] = {
    SELF_PARAMETER,
    [STEP_X] = {"x", KIND_NUMBER, 0, ANY, NULL, NULL, "Factor along x."},
    [STEP_Y] = {"y", KIND_NUMBER, 0, ANY, NULL, NULL, "Factor along y."},
    [STEP_Z] = {"z", KIND_NUMBER, 0, ANY, NULL, NULL, "Factor along z."},
    [STEP_VECTOR] = {"vector", KIND_TRIPLE, 0, ANY, NULL, NULL, "The three numbers as a table."},
};

static const struct script_parameter rotate_parameters[] = {
    SELF_PARAMETER,
    [ROTATE_AXIS] = {"axis", KIND_AXIS, 0, 0, 0, "x y z", NULL, NULL, "The axis, in either case."},
    [ROTATE_ANGLE] = {"angle", KIND_NUMBER, 0, ANY, "degrees", NULL,
                      "Angle, counterclockwise when the axis points to the viewer."},
};

static const struct script_parameter rotate_axis_parameters[] = {
    SELF_PARAMETER,
    [ROTATE_AXIS] = {"axis", KIND_DIRECTION, 0, ANY, NULL, NULL, "The axis, of any length except 0."},
    [ROTATE_ANGLE] = {"angle", KIND_NUMBER, 0, ANY, "degrees", NULL,
                      "Angle, counterclockwise when the axis points to the viewer."},
};

static const struct script_parameter rotate_quat_parameters[] = {
    SELF_PARAMETER,
    [QUAT_W] = {"w", KIND_NUMBER, 0, ANY, NULL, NULL, "Cosine of half the angle; gray normalises the quaternion."},
    [QUAT_X] = {"x", KIND_NUMBER, 0, ANY, NULL, NULL, "x of the unit axis, times the sine of half the angle."},
    [QUAT_Y] = {"y", KIND_NUMBER, 0, ANY, NULL, NULL, "The same for y."},
    [QUAT_Z] = {"z", KIND_NUMBER, 0, ANY, NULL, NULL, "The same for z."},
    [QUAT_TABLE] = {"quaternion", KIND_QUATERNION, 0, ANY, NULL, NULL, "The four numbers as a table."},
};

static const struct script_parameter pose_parameters[] = {
    SELF_PARAMETER,
    [POSE_TRANSLATE] = {"translate", KIND_POINT, OPTIONAL, ANY, NULL, "{0, 0, 0}", "Translation, the last step."},
    [POSE_ROTATE] = {"rotate", KIND_QUATERNION, OPTIONAL, ANY, NULL, "{1, 0, 0, 0}",
                     "Rotation, a quaternion {w, x, y, z} as for node:rotate_quat."},
    [POSE_SCALE] = {"scale", KIND_SIZE, OPTIONAL, ANY, NULL, "1",
                    "Scale factor, the first step, one number or three; of 0 nothing is drawn."},
};

#define KD                                                                                                             \
    { "kd", KIND_COLOUR, OR_TEXTURE, ANY, NULL, NULL, "Diffuse and ambient colour." }
#define KS                                                                                                             \
    {                                                                                                                  \
        "ks", KIND_COLOUR, OPTIONAL | OR_TEXTURE, ANY, NULL, "{0, 0, 0}",                                              \
            "Colour of highlights; filter of reflected and refracted rays."                                            \
    }
#define SHININESS                                                                                                      \
    { "shininess", KIND_NUMBER, OPTIONAL | OR_TEXTURE, ABOVE(0), NULL, "1", "Exponent of the highlight." }
#define TWO_SIDED                                                                                                      \
    { "two_sided", KIND_BOOLEAN, OPTIONAL, ANY, NULL, "false", "Whether faces seen from behind are lit, too." }

#define SURFACE_FIELDS                                                                                                 \
    [PHONG_HIGHLIGHT] = {"highlight",                                                                                  \
                         KIND_CHOICE,                                                                                  \
                         OPTIONAL,                                                                                     \
                         0,                                                                                            \
                         0,                                                                                            \
                         LIST_BLANKS(HIGHLIGHTS),                                                                      \
                         NULL,                                                                                         \
                         "specular of the render",                                                                     \
                         "Formula of the highlight."},                                                                 \
    [PHONG_LIT] =                                                                                                      \
        {"lit", KIND_BOOLEAN, OPTIONAL, ANY, NULL, "true", "Whether light affects it; false: it shows kd unchanged."}, \
    [PHONG_EMISSION] = {"emission",                                                                                    \
                        KIND_COLOUR,                                                                                   \
                        OPTIONAL | OR_TEXTURE,                                                                         \
                        ANY,                                                                                           \
                        NULL,                                                                                          \
                        "{0, 0, 0}",                                                                                   \
                        "Emitted light, added to reflected light."},                                                   \
    [PHONG_ROUGHNESS] = {"roughness",                                                                                  \
                         KIND_NUMBER,                                                                                  \
                         OPTIONAL | OR_TEXTURE,                                                                        \
                         IN_RANGE(0, 1),                                                                               \
                         NULL,                                                                                         \
                         "0",                                                                                          \
                         "Roughness of reflection and refraction; 0 is polished."},                                    \
    [PHONG_GLOSSY_SAMPLES] = {"glossy_samples",                                                                        \
                              KIND_WHOLE,                                                                              \
                              OPTIONAL,                                                                                \
                              IN_RANGE(1, 64),                                                                         \
                              NULL,                                                                                    \
                              "4",                                                                                     \
                              "N x N rays from a rough surface; after the first rough surface of a path, one ray."},   \
    [PHONG_ABSORPTION] = {"absorption",                                                                                \
                          KIND_COLOUR,                                                                                 \
                          OPTIONAL,                                                                                    \
                          ABOVE(0),                                                                                    \
                          NULL,                                                                                        \
                          "{0, 0, 0}",                                                                                 \
                          "Absorption inside the solid: factor exp(-absorption * distance)."},                         \
    [PHONG_OPACITY] = {"opacity",                                                                                      \
                       KIND_NUMBER,                                                                                    \
                       OPTIONAL | OR_TEXTURE,                                                                          \
                       IN_RANGE(0, 1),                                                                                 \
                       NULL,                                                                                           \
                       "1",                                                                                            \
                       "Opacity of the surface; below 1 it has holes."},                                               \
    [PHONG_METALNESS] = {"metalness",                                                                                  \
                         KIND_NUMBER,                                                                                  \
                         OPTIONAL | OR_TEXTURE,                                                                        \
                         IN_RANGE(0, 1),                                                                               \
                         NULL,                                                                                         \
                         "0",                                                                                          \
                         "Fraction of kd that replaces ks."},                                                          \
    [PHONG_BUMP] = {"bump",                                                                                            \
                    KIND_IMAGE,                                                                                        \
                    OPTIONAL | OR_TEXTURE,                                                                             \
                    ANY,                                                                                               \
                    NULL,                                                                                              \
                    "none",                                                                                            \
                    "Heights: a result of gr.bump, a file or a texture."}

static const struct script_parameter material_parameters[] = {
    [PHONG_KD] = KD,
    [PHONG_KS] = KS,
    [PHONG_SHININESS] = SHININESS,
    [PHONG_REFLECT] = {"reflect", KIND_NUMBER, OPTIONAL | OR_TEXTURE, IN_RANGE(0, 1), NULL, "0",
                       "Amount of reflection."},
    [PHONG_REFRACT] = {"refract", KIND_NUMBER, OPTIONAL | OR_TEXTURE, IN_RANGE(0, 1), NULL, "0",
                       "Amount of refraction."},
    [PHONG_IOR] = {"ior", KIND_NUMBER, OPTIONAL, ABOVE(1), NULL, "none", "Index of refraction inside the solid."},
    [PHONG_TWO_SIDED] = TWO_SIDED,
    SURFACE_FIELDS,
};

static const struct script_parameter rr_parameters[] = {
    [PHONG_KD] = KD,
    [PHONG_KS] = KS,
    [PHONG_SHININESS] = SHININESS,
    [PHONG_REFLECT] = {"reflect", KIND_NUMBER, OPTIONAL | OR_TEXTURE, IN_RANGE(0, 1), NULL, "0",
                       "Amount of reflection."},
    [PHONG_REFRACT] = {"refract", KIND_NUMBER, OPTIONAL | OR_TEXTURE, IN_RANGE(0, 1), NULL, "0",
                       "Amount of refraction."},
    [PHONG_IOR] = {"ior", KIND_NUMBER, OPTIONAL, ABOVE(1), NULL, "1", "Index of refraction inside the solid."},
    [PHONG_TWO_SIDED] = TWO_SIDED,
    SURFACE_FIELDS,
};

#define BASE                                                                                                           \
    { "material", KIND_MATERIAL, 0, ANY, NULL, NULL, "The base material." }
#define INTERP                                                                                                         \
    { "interp", KIND_WHOLE, OPTIONAL, IN_RANGE(0, 1), NULL, "0", "Interpolation of the noise: 0 linear, 1 cosine." }
#define MIX                                                                                                            \
    { "mix", KIND_COLOUR, OR_DISPLAY, ANY, NULL, NULL, "Colour to mix with kd." }

static const struct script_parameter marble_parameters[] = {
    [MARBLE_MATERIAL] = BASE,
    [MARBLE_F] = {"f", KIND_NUMBER, 0, ANY, NULL, NULL, "Factor of the point before the noise."},
    [MARBLE_MULTIPLIER] = {"multiplier", KIND_NUMBER, 0, ANY, NULL, NULL, "Strength of the noise in the veins."},
    [MARBLE_VEIN] = {"vein_frequency", KIND_NUMBER, 0, ANY, NULL, NULL, "Frequency of the veins along y."},
    [MARBLE_INTERP] = INTERP,
    [MARBLE_MIX] = MIX,
};

static const struct script_parameter wood_parameters[] = {
    [WOOD_MATERIAL] = BASE,
    [WOOD_F] = {"f", KIND_NUMBER, 0, ANY, NULL, NULL, "Factor of the point before the noise."},
    [WOOD_DENSITY] = {"density", KIND_NUMBER, 0, ANY, NULL, NULL, "Density of the grain."},
    [WOOD_INTERP] = INTERP,
    [WOOD_MIX] = MIX,
};

#define FILTER                                                                                                         \
    { "filter", KIND_CHOICE, OPTIONAL, 0, 0, LIST_BLANKS(IMAGE_FILTERS), NULL, "'mipmap'", "Filter of the lookup." }
#define WRAP_PARAMETER                                                                                                 \
    { "wrap", KIND_CHOICE, OPTIONAL, 0, 0, LIST_BLANKS(IMAGE_WRAPS), NULL, "'repeat'", "Lookup outside of the image." }
#define FLIP_U                                                                                                         \
    { "flip_u", KIND_BOOLEAN, OPTIONAL, ANY, NULL, "false", "Whether the image is mirrored from left to right." }

#define SPHERE_MAPPING                                                                                                 \
    {                                                                                                                  \
        "mapping", KIND_CHOICE, OPTIONAL, 0, 0, LIST_BLANKS(SPHERE_MAPPINGS), NULL, "'classic'",                       \
            "On spheres: classic is mirrored, seen from outside; outside is not."                                      \
    }

static const struct script_parameter image_parameters[] = {
    [IMAGE_MATERIAL] = BASE,
    [IMAGE_PNG] = {"png", KIND_IMAGE, 0, ANY, NULL, NULL, "A PNG or JPEG file, or a texture."},
    [IMAGE_FILTER] = FILTER,
    [IMAGE_FLIP_U] = FLIP_U,
    [IMAGE_MAPPING] = SPHERE_MAPPING,
};

#define TILES                                                                                                          \
    { "tiles", KIND_PAIR, OPTIONAL, ANY, NULL, "1", "Number of repetitions: one number, or {across, up}." }
#define OFFSET                                                                                                         \
    { "offset", KIND_PAIR, OPTIONAL, ANY, NULL, "0", "Shift in units of the image: one number, or {across, up}." }
#define ENCODING                                                                                                       \
    {                                                                                                                  \
        "encoding", KIND_CHOICE, OPTIONAL | OR_NUMBER | LOW_OPEN, 0, 10, LIST_BLANKS(TEXTURE_ENCODINGS), NULL,         \
            "'auto'",                                                                                                  \
            "Meaning of its numbers for linear colours; auto: as the file states, otherwise sRGB for colours of 8 "    \
            "bits; a number is a gamma."                                                                               \
    }
#define LOOKUP_FIELDS(first)                                                                                           \
    [first + LOOKUP_FILTER] = FILTER, [first + LOOKUP_WRAP] = WRAP_PARAMETER, [first + LOOKUP_FLIP_U] = FLIP_U,        \
             [first + LOOKUP_TILES] = TILES, [first + LOOKUP_OFFSET] = OFFSET, [first + LOOKUP_ENCODING] = ENCODING,   \
             [first + LOOKUP_MAPPING] = SPHERE_MAPPING

static const struct script_parameter texture_parameters[] = {
    [TEXTURE_FILE] = {"file", KIND_IMAGE, 0, ANY, NULL, NULL, "A PNG or JPEG file."},
    LOOKUP_FIELDS(TEXTURE_LOOKUP),
};

#define BUMP_AMOUNT_FIELD                                                                                              \
    {                                                                                                                  \
        "height", KIND_NUMBER, OPTIONAL, ANY, NULL, "1/50 of the picture's size; 1 for normals",                       \
            "Height of white above black, in units of the object; for normals, a factor of the slopes."                \
    }
#define BUMP_KIND_FIELD                                                                                                \
    {                                                                                                                  \
        "kind", KIND_CHOICE, OPTIONAL, 0, 0, LIST_BLANKS(BUMP_KINDS), NULL, "'bump'",                                  \
            "Contents: heights, or normals as colours (x right, y up, z outwards)."                                    \
    }

static const struct script_parameter bump_parameters[] = {
    [BUMP_FILE] = {"file", KIND_IMAGE, OR_TEXTURE, ANY, NULL, NULL, "A PNG or JPEG file, or any texture."},
    LOOKUP_FIELDS(BUMP_LOOKUP),
    [BUMP_AMOUNT] = BUMP_AMOUNT_FIELD,
    [BUMP_KIND] = BUMP_KIND_FIELD,
};

static const struct script_parameter image_over_parameters[] = {
    [OVER_MATERIAL] = BASE,
    [OVER_IMAGE] = {"image", KIND_IMAGE, 0, ANY, NULL, NULL, "A PNG or JPEG file, or a texture."},
    LOOKUP_FIELDS(OVER_LOOKUP),
    [OVER_CHANNEL] = {"channel", KIND_CHOICE, OPTIONAL, 0, 0, LIST_BLANKS(IMAGE_CHANNELS), NULL, "'kd'",
                      "The input that the image replaces; where opacity is below 1, the surface has holes."},
};

static const struct script_parameter bump_over_parameters[] = {
    [OVER_MATERIAL] = BASE,
    [OVER_IMAGE] = {"image", KIND_IMAGE, OR_TEXTURE, ANY, NULL, NULL, "A PNG or JPEG file, or a result of gr.bump."},
    LOOKUP_FIELDS(OVER_LOOKUP),
    [BUMP_OVER_AMOUNT] = BUMP_AMOUNT_FIELD,
    [BUMP_OVER_KIND] = BUMP_KIND_FIELD,
};

static const struct script_parameter fresnel_parameters[] = {[FRESNEL_MATERIAL] = BASE};

#define SKY_FIELDS                                                                                                     \
    [SKY_INTENSITY] = {"intensity", KIND_NUMBER, OPTIONAL, ABOVE(0), NULL, "1", "Factor of its brightness."},          \
    [SKY_ROTATION] = {                                                                                                 \
        "rotation", KIND_NUMBER, OPTIONAL, ANY, "degrees", "0", "Rotation about y, counterclockwise seen from above."}
#define SKY_FACE(text)                                                                                                 \
    { text, KIND_IMAGE, 0, ANY, NULL, NULL, "A square picture, as seen from the centre." }
#define SUN(first)                                                                                                     \
    [(first) +                                                                                                         \
        SUN_DIRECTION] =                                                                                               \
        {"sun", KIND_DIRECTION, OPTIONAL, ANY, NULL, NULL, "Direction to the sun, instead of time and position."},     \
        [(first) + SUN_HOUR] = {"hour", KIND_NUMBER, OPTIONAL, IN_RANGE(0, 24), NULL, "12", "Local time of day."},     \
        [(first) +                                                                                                     \
            SUN_DAY] = {"day", KIND_WHOLE, OPTIONAL, IN_RANGE(1, 366), NULL, "172, 21 June", "Day of the year."},      \
        [(first) + SUN_LATITUDE] = {"latitude",                                                                        \
                                    KIND_NUMBER,                                                                       \
                                    OPTIONAL,                                                                          \
                                    IN_RANGE(-90, 90),                                                                 \
                                    "degrees",                                                                         \
                                    "45",                                                                              \
                                    "Positive is north; in the scene, -z is north and +x is east."},                   \
        [(first) + SUN_LONGITUDE] = {"longitude", KIND_NUMBER, OPTIONAL,           IN_RANGE(-180, 180),                \
                                     "degrees",   "0",         "Positive is east."},                                   \
        [(first) + SUN_ZONE] = {"zone",                                                                                \
                                KIND_NUMBER,                                                                           \
                                OPTIONAL,                                                                              \
                                IN_RANGE(-14, 14),                                                                     \
                                "hours",                                                                               \
                                "0",                                                                                   \
                                "Difference of the local time to Greenwich; positive is east."},                       \
        [(first) + SUN_YEAR] = {"year", KIND_WHOLE, OPTIONAL, IN_RANGE(1901, 2099), NULL, "2025", "Year of the day."}

static const struct script_parameter sky_faces_parameters[] = {
    SKY_FIELDS,
    [FACES_FRONT] = SKY_FACE("front"),
    [FACES_RIGHT] = SKY_FACE("right"),
    [FACES_BACK] = SKY_FACE("back"),
    [FACES_LEFT] = SKY_FACE("left"),
    [FACES_TOP] = SKY_FACE("top"),
    [FACES_BOTTOM] = SKY_FACE("bottom"),
};

static const struct script_parameter sky_cross_parameters[] = {
    SKY_FIELDS,
    [CROSS_IMAGE] = {"image", KIND_IMAGE, 0, ANY, NULL, NULL, "A picture file with six views in a 4 x 3 cross."},
    [CROSS_MIRROR] = {"mirror", KIND_BOOLEAN, OPTIONAL, ANY, NULL, "false", "Whether the cross is mirrored."},
};

static const struct script_parameter sky_map_parameters[] = {
    SKY_FIELDS,
    [MAP_IMAGE] = {"image", KIND_IMAGE, 0, ANY, NULL, NULL,
                   "Picture of the whole sphere, longitude by latitude, with -z in the middle and +x to the right. "
                   "Radiance HDR, PFM and EXR files hold values above 1."},
};

static const struct script_parameter sky_gradient_parameters[] = {
    SKY_FIELDS,
    [GRADIENT_STOPS] = {"stops", KIND_STOPS, 0, ANY, NULL, NULL,
                        "Colours by height, {y, r, g, b}; y of the unit direction, from -1 to 1; linear between."},
};

static const struct script_parameter sky_function_parameters[] = {
    SKY_FIELDS,
    [SKYFUNCTION_F] = {"f", KIND_FUNCTION, OR_PROFILE, ANY, NULL, NULL,
                       "A function of the unit direction; it returns a colour or a number."},
};

static const struct script_parameter clear_sky_parameters[] = {
    SKY_FIELDS,
    SUN(CLEAR_SUN),
    [CLEAR_TURBIDITY] = {"turbidity", KIND_NUMBER, OPTIONAL, IN_RANGE(1.7, 10), NULL, "2.5",
                         "Turbidity of the air: 2 is very clear, 10 is hazy."},
    [CLEAR_GROUND] = {"ground", KIND_COLOUR, OPTIONAL | OR_DISPLAY, ANY, NULL, "{0.15, 0.15, 0.15}",
                      "Colour below the horizon."},
};

static const struct script_parameter sun_light_parameters[] = {
    LIGHT_FIELDS(0),
    SUN(SUNLIGHT_SUN),
};

#define FOG_CLEAR_SKY_FIELD                                                                                            \
    [FOG_CLEAR_SKY] = {                                                                                                \
        "clear_sky", KIND_BOOLEAN, OPTIONAL, ANY, NULL, "false", "Whether the fog leaves the sky unchanged."}
#define FOG_FIELDS                                                                                                     \
    [FOG_COLOUR] = {"colour", KIND_COLOUR, OPTIONAL | OR_DISPLAY, ANY, NULL, "{0.5, 0.5, 0.5}", "Its colour."},        \
    FOG_CLEAR_SKY_FIELD
#define FOG_DENSITY(text) [FOG_AMOUNT] = {"density", KIND_NUMBER, 0, ABOVE(0), NULL, NULL, text}

static const struct script_parameter fog_parameters[] = {
    FOG_FIELDS,
    FOG_DENSITY("Transmittance over distance d is exp(-density d)."),
    [FOG_IS_SQUARED] = {"squared", KIND_BOOLEAN, OPTIONAL, ANY, NULL, "false",
                        "Transmittance is exp(-(density d)^2) instead."},
};

static const struct script_parameter linear_fog_parameters[] = {
    FOG_FIELDS,
    [FOG_NEAR] = {"near", KIND_NUMBER, OPTIONAL, ABOVE(0), NULL, "0", "Distance where the fog begins."},
    [FOG_FAR] = {"far", KIND_NUMBER, LOW_OPEN, ABOVE(0), NULL, NULL, "Distance where the transmittance is 0."},
};

static const struct script_parameter height_fog_parameters[] = {
    FOG_FIELDS,
    FOG_DENSITY("Density at the base."),
    [FOG_BASE] = {"base", KIND_NUMBER, OPTIONAL, ANY, NULL, "0", "Height y of the base."},
    [FOG_SCALE] = {"scale", KIND_NUMBER, OPTIONAL | LOW_OPEN, ABOVE(0), NULL, "1",
                   "Height over which the density falls by the factor e."},
};

static const struct script_parameter fog_profile_parameters[] = {
    FOG_FIELDS,
    [FOG_PROFILE_TABLE] = {"profile", KIND_PAIRS, 0, ANY, NULL, NULL,
                           "Densities by height, {y, density}; linear between the entries, constant beyond them."},
};

static const struct script_parameter fog_grid_parameters[] = {
    FOG_FIELDS,
    [FOG_CORNER] = {"corner", KIND_POINT, 0, ANY, NULL, NULL, "The corner with the smallest coordinates."},
    [FOG_SIZE] = {"size", KIND_SIZE, LOW_OPEN, ABOVE(0), NULL, NULL, "Length of the edges, one number or three."},
    [FOG_CELLS] = {"cells", KIND_TRIPLE, 0, 1, 1024, NULL, NULL, NULL, "Number of cells along x, y and z."},
    [FOG_DENSITIES] = {"densities", KIND_NUMBERS, 0, ABOVE(0), NULL, NULL,
                       "Density of each cell; x varies fastest, then y, then z."},
};

static const struct script_parameter fog_field_parameters[] = {
    [FOG_COLOUR] = {"colour", KIND_COLOUR, OPTIONAL | OR_DISPLAY | OR_FUNCTION, ANY, NULL, "{0.5, 0.5, 0.5}",
                    "Its colour, or a function f(p, s) of the point, s.view and s.time."},
    FOG_CLEAR_SKY_FIELD,
    [FOG_CORNER] = {"corner", KIND_POINT, 0, ANY, NULL, NULL, "The corner with the smallest coordinates."},
    [FOG_SIZE] = {"size", KIND_SIZE, LOW_OPEN, ABOVE(0), NULL, NULL, "Length of the edges, one number or three."},
    [FOG_FIELD_DENSITY] = {"density", KIND_FUNCTION, 0, ANY, NULL, NULL,
                           "A function f(p, s) of the point and s.time; it returns a number of at least 0."},
};

_Static_assert((int)RENDER_COUNT <= (int)PARAMETER_LIMIT, "no function has more parameters than gr.render");
static const struct script_parameter render_parameters[] = {
    [RENDER_NODE] = {"node", KIND_NODE, 0, ANY, NULL, NULL, "Root node of the picture."},
    [RENDER_FILE] = {"file", KIND_OUTPUT, 0, ANY, NULL, NULL,
                     "Picture file: .png, or .pfm, .hdr or .exr for linear light; gray creates missing folders."},
    [RENDER_SKY] = {"sky", KIND_IMAGE, OPTIONAL, ANY, NULL, NULL,
                    "A PNG or JPEG file with six views of the sky in a 4 x 3 cross."},
    [RENDER_WIDTH] = {"width", KIND_WHOLE, 0, 1, 1 << 20, NULL, "pixels", NULL, "Width of the picture."},
    [RENDER_HEIGHT] = {"height", KIND_WHOLE, 0, 1, 1 << 20, NULL, "pixels", NULL, "Height of the picture."},
    [RENDER_EYE] = {"eye", KIND_POINT, 0, ANY, NULL, NULL, "Position of the camera."},
    [RENDER_VIEW] = {"view", KIND_DIRECTION, OPTIONAL, ANY, NULL, "{0, 0, -1}", "Direction of view."},
    [RENDER_UP] = {"up", KIND_DIRECTION, OPTIONAL, ANY, NULL, "{0, 1, 0}", "Direction that is up in the picture."},
    [RENDER_FOV] = {"fov", KIND_NUMBER, OPTIONAL | LOW_OPEN | HIGH_OPEN, 0, 180, NULL, "degrees", "50",
                    "Full vertical angle of view."},
    [RENDER_AMBIENT] = {"ambient", KIND_COLOUR, OPTIONAL | OR_DISPLAY, ANY, NULL, "{0, 0, 0}", "Ambient light."},
    [RENDER_LIGHTS] = {"lights", KIND_LIGHTS, OPTIONAL, ANY, NULL, "{}", "The lights."},
    [RENDER_TARGET] = {"target", KIND_POINT, OPTIONAL, ANY, NULL, NULL, "Point to look at, instead of view."},
    [RENDER_BACKGROUND] = {"background", KIND_BACKGROUND, OPTIONAL, ANY, NULL, "'gradient'",
                           "Background for rays that hit nothing: a colour, a sky, a function of the unit direction, "
                           "or 'gradient' for {0, 0, (1 + y)/2}. If all pictures of the script have the form "
                           "gr.render{...} without background, the default is light and neutral."},
    [RENDER_MIRROR] = {"mirror", KIND_BOOLEAN, OPTIONAL, ANY, NULL, "false", "Whether the sky cross is mirrored."},
    [RENDER_SAMPLES] = {"samples", KIND_WHOLE, OPTIONAL, IN_RANGE(1, 64), NULL, "-ss",
                        "N x N samples for a marked pixel."},
    [RENDER_FULL] = {"full", KIND_BOOLEAN, OPTIONAL, ANY, NULL, "-full", "Whether every pixel gets N x N samples."},
    [RENDER_AREA_SAMPLES] = {"area_samples", KIND_WHOLE, OPTIONAL, IN_RANGE(1, 64), NULL, "-al-samples",
                             "N x N shadow rays for an area light."},
    [RENDER_REFLECT_LIMIT] = {"reflect_limit", KIND_WHOLE, OPTIONAL, IN_RANGE(0, 1000), NULL, "-reflect-limit",
                              "How often a path may reflect."},
    [RENDER_REFRACT_LIMIT] = {"refract_limit", KIND_WHOLE, OPTIONAL, IN_RANGE(0, 1000), NULL, "-refract-limit",
                              "How often a path may refract."},
    [RENDER_SIDE_TOLERANCE] = {"side_tolerance", KIND_NUMBER, OPTIONAL, ABOVE(0), NULL, "-side-tolerance",
                               "Squared distance of colours between side neighbours that marks a pixel."},
    [RENDER_CORNER_TOLERANCE] = {"corner_tolerance", KIND_NUMBER, OPTIONAL, ABOVE(0), NULL, "-corner-tolerance",
                                 "The same between corner neighbours."},
    [RENDER_USE_TIR] = {"use_tir", KIND_BOOLEAN, OPTIONAL, ANY, NULL, "-use-tir",
                        "Whether total internal reflection adds the refracted amount to the reflected one."},
    [RENDER_SPECULAR] = {"specular", KIND_CHOICE, OPTIONAL, 0, 0, LIST_BLANKS(SPECULAR_KINDS), NULL, "--specular",
                         "Formula of highlights."},
    [RENDER_SEED] = {"seed", KIND_WHOLE, OPTIONAL, IN_RANGE(0, 0x1p53 - 1), NULL, "--seed", "Seed of random numbers."},
    [RENDER_ACCEL] = {"accel", KIND_CHOICE, OPTIONAL, 0, 0, LIST_BLANKS(ACCEL_KINDS), NULL, "'auto'",
                      "Acceleration structure; the picture is the same."},
    [RENDER_FOG] = {"fog", KIND_FOG, OPTIONAL, ANY, NULL, "none", "A fog."},
    [RENDER_CAUSTICS] = {"caustics", KIND_CAUSTICS, OPTIONAL, ANY, NULL, "--caustics",
                         "Caustics: number of photons (default 200000) and radius of the disc that each one lights "
                         "(default: from their density)."},
    [RENDER_CUTOFF] = {"cutoff", KIND_NUMBER, OPTIONAL, IN_RANGE(0, 1), NULL, "--cutoff",
                       "gray does not trace rays that can change a pixel by less than this."},
    [RENDER_INTEGRATOR] =
        {"integrator", KIND_CHOICE, OPTIONAL, 0, 0, LIST_BLANKS(INTEGRATORS), NULL, "--integrator",
         "The method: whitted has direct light, mirrors and glass; path also has indirect light from all surfaces."},
    [RENDER_SPP] = {"spp", KIND_WHOLE, OPTIONAL, IN_RANGE(1, PATH_SAMPLES_MAX), NULL, "--spp, else 64",
                    "Samples per pixel of integrator path; the option has priority."},
    [RENDER_MAX_DEPTH] = {"max_depth", KIND_WHOLE, OPTIONAL, IN_RANGE(0, DEPTH_MAX), NULL, "--max-depth",
                          "Scattering events of a path: 0 shows emission only, 1 direct light."},
    [RENDER_NOISE] =
        {"noise", KIND_NUMBER, OPTIONAL, IN_RANGE(1e-6, 10), NULL, "--noise, else all samples",
         "Relative standard error at which a tile of integrator path is finished; the option has priority."},
    [RENDER_CLAMP] =
        {"clamp", KIND_NUMBER, OPTIONAL, ABOVE(0), NULL, "--clamp",
         "Largest component of a sample of integrator path; 0: no limit. A limit makes the picture darker."},
    [RENDER_FILTER] = {"filter", KIND_CHOICE, OPTIONAL, 0, 0, LIST_BLANKS(FILTERS), NULL, "--filter",
                       "Reconstruction filter of a pixel."},
    [RENDER_DENOISE] = {"denoise", KIND_BOOLEAN, OPTIONAL, ANY, NULL, "--denoise",
                        "Whether integrator path removes noise; the option has priority."},
    [RENDER_EXPOSURE] = {"exposure", KIND_NUMBER, OPTIONAL, IN_RANGE(-100, 100), "stops", "--exposure",
                         "Light is multiplied by 2^exposure when a PNG file is written."},
    [RENDER_TONE] =
        {"tone", KIND_CHOICE, OPTIONAL | OR_CURVE, 0, 0, LIST_BLANKS(TONE_CURVES), NULL, "--tone",
         "Tone curve that maps bright light into the range of a PNG file, or a function f(x) of the light x "
         "from 0 on, the same for red, green and blue; the option has priority over a function."},
    [RENDER_SRGB] = {"srgb", KIND_BOOLEAN, OPTIONAL, ANY, NULL, "--srgb",
                     "Whether PNG files are encoded with the sRGB transfer function."},
    [RENDER_COLOUR] = {"colour", KIND_CHOICE, OPTIONAL, 0, 0, LIST_BLANKS(COLOUR_PIPELINES), NULL, "--colour",
                       "Whether colours are linear light or the numbers of files; auto: linear with integrator path."},
    [RENDER_DEEP] = {"deep", KIND_BOOLEAN, OPTIONAL, ANY, NULL, "--deep",
                     "Whether PNG files have 16 bits per channel."},
    [RENDER_STYLE] =
        {"style", KIND_CHOICE, OPTIONAL, 0, 0, LIST_BLANKS(STYLES), NULL, "--style",
         "Pictures that look like drawings: lines, levels of light, cool to warm colours; with integrator whitted."},
    [RENDER_LINE_WIDTH] = {"line_width", KIND_NUMBER, OPTIONAL, IN_RANGE(0, LINE_WIDTH_MAX), "pixels", "--line-width",
                           "Width of lines where objects, normals and depths change."},
    [RENDER_TOON_STEPS] = {"toon_steps", KIND_WHOLE, OPTIONAL, IN_RANGE(1, TOON_STEPS_MAX), NULL, "--toon-steps",
                           "Number of levels of light of style toon, not counting shadow."},
    [RENDER_BLOOM] = {"bloom", KIND_NUMBER, OPTIONAL, IN_RANGE(0, 1), NULL, "--bloom",
                      "Weight of the light above white that spreads around it."},
    [RENDER_VIGNETTE] = {"vignette", KIND_NUMBER, OPTIONAL, IN_RANGE(0, 1), NULL, "--vignette",
                         "Darkens the corners; with 1 they have a quarter of their light."},
    [RENDER_GRAY] = {"gray", KIND_BOOLEAN, OPTIONAL, ANY, NULL, "--gray", "Whether the picture is its luminance."},
    [RENDER_EDGES] = {"edges", KIND_BOOLEAN, OPTIONAL, ANY, NULL, "--edges",
                      "Whether PNG files show the edges of the picture, white on black."},
    [RENDER_FXAA] = {"fxaa", KIND_BOOLEAN, OPTIONAL, ANY, NULL, "--fxaa",
                     "Whether the edges in PNG files are smoothed."},
    [RENDER_DITHER] = {"dither", KIND_CHOICE, OPTIONAL, 0, 0, LIST_BLANKS(DITHERS), NULL, "--dither",
                       "Pattern by which PNG files are rounded to 8 bits."},
    [RENDER_PROJECTION] = {"projection", KIND_CHOICE, OPTIONAL, 0, 0, LIST_BLANKS(PROJECTIONS), NULL, "'perspective'",
                           "Fisheye: equidistant, inside a circle; panorama: 360 degrees, longitude by latitude."},
    [RENDER_VIEW_HEIGHT] = {"view_height", KIND_NUMBER, OPTIONAL | LOW_OPEN, ABOVE(0), NULL, "2",
                            "Height of an orthographic picture, in units of the scene."},
    [RENDER_ANGLE] = {"angle", KIND_NUMBER, OPTIONAL | LOW_OPEN, IN_RANGE(0, 360), "degrees", "180",
                      "Full angle of a fisheye across the height."},
    [RENDER_SHIFT_X] = {"shift_x", KIND_NUMBER, OPTIONAL, ANY, "widths", "0", "Shift of the window to the right."},
    [RENDER_SHIFT_Y] = {"shift_y", KIND_NUMBER, OPTIONAL, ANY, "heights", "0", "Shift of the window upwards."},
    [RENDER_APERTURE] =
        {"aperture", KIND_NUMBER, OPTIONAL, ABOVE(0), NULL, "0",
         "Radius of the lens, in units of the scene; 0 is a pinhole. With a lens, gray resamples every pixel."},
    [RENDER_FOCUS] = {"focus", KIND_NUMBER, OPTIONAL | LOW_OPEN, ABOVE(0), NULL, "target, else 1",
                      "Distance of the plane in focus, along the view."},
    [RENDER_FOCUS_POINT] = {"focus_point", KIND_POINT, OPTIONAL, ANY, NULL, NULL,
                            "A point of the plane in focus, instead of focus."},
    [RENDER_BLADES] = {"blades", KIND_WHOLE, OPTIONAL, IN_RANGE(3, 64), NULL, "round",
                       "Number of blades: the aperture is a polygon."},
    [RENDER_BLADE_ANGLE] = {"blade_angle", KIND_NUMBER, OPTIONAL, ANY, "degrees", "0", "Rotation of that polygon."},
    [RENDER_STEREO] = {"stereo", KIND_CHOICE, OPTIONAL, 0, 0, LIST_BLANKS(STEREOS), NULL, "'none'",
                       "Two eyes: side by side (left picture on the left), or red and cyan."},
    [RENDER_EYE_DISTANCE] = {"eye_distance", KIND_NUMBER, OPTIONAL, ABOVE(0), NULL, "screen / 30",
                             "Distance between the eyes."},
    [RENDER_SCREEN] = {"screen", KIND_NUMBER, OPTIONAL | LOW_OPEN, ABOVE(0), NULL, "focus",
                       "Distance along the view where both eyes see the same point of the picture."},
    [RENDER_SHUTTER] = {"shutter", KIND_INTERVAL, OPTIONAL, ANY, NULL, "{0, 1}",
                        "Times when the shutter opens and closes, {open, close}; motion between them is blurred."},
    [RENDER_EYE_TO] = {"eye_to", KIND_POINT, OPTIONAL, ANY, NULL, "eye", "Position of a moving camera at time 1."},
    [RENDER_VIEW_TO] = {"view_to", KIND_DIRECTION, OPTIONAL, ANY, NULL, "view", "Its direction of view at time 1."},
    [RENDER_TARGET_TO] = {"target_to", KIND_POINT, OPTIONAL, ANY, NULL, "target", "The point to look at, at time 1."},
    [RENDER_UP_TO] = {"up_to", KIND_DIRECTION, OPTIONAL, ANY, NULL, "up", "Its up direction at time 1."},
};

static const struct script_parameter glyphs_parameters[] = {
    [GLYPHS_FONT] = {"font", KIND_FILE, 0, ANY, NULL, NULL, "A font file: TrueType, OpenType or Type 1."},
    [GLYPHS_TEXT] = {"text", KIND_TEXT, 0, ANY, NULL, NULL, "One line of text, in UTF-8."},
};

#define VN_FORM(first) first " verts normals faces face_normals"
#define RENDER_TAIL " width height eye view up fov ambient? lights?"

static const struct script_function node_rows[] = {
    GR("node", group_parameters, RESULT_NODE, gr_node, "A node with children and a transform.", "name?"),
    GR("instances", instances_parameters, RESULT_NODE, gr_instances,
       "A node at many positions; each position costs a tenth of the memory of a node.", "of at"),
    GR("joint", joint_parameters, RESULT_NODE, gr_joint,
       "A node that rotates about x and y, with limits of the angles.", "name x y"),
    GR("sphere", sphere_parameters, RESULT_NODE, gr_sphere, "A sphere; by default of radius 1 at the origin.",
       "material", "name"),
    GR("cube", cube_parameters, RESULT_NODE, gr_cube, "A cube; by default from (0,0,0) to (1,1,1).", "material",
       "name"),
    GR("nh_sphere", sphere_parameters, RESULT_NODE, gr_sphere, "A sphere with centre and radius.", "name centre radius",
       "material centre radius"),
    GR("nh_box", cube_parameters, RESULT_NODE, gr_cube, "A cube with corner and size.", "name corner size",
       "material corner size"),
    GR("mesh", mesh_parameters, RESULT_NODE, gr_mesh, "A mesh of polygons, flat or with vertex normals.",
       "material verts faces", "name file", "name verts faces", "material file"),
    GR("fast_mesh", mesh_parameters, RESULT_NODE, gr_mesh, "The same as gr.mesh: every mesh is fast.",
       "material verts faces", "name verts faces"),
    GR("vn_mesh", mesh_parameters, RESULT_NODE, gr_mesh, "A mesh with vertex normals.", VN_FORM("material"),
       VN_FORM("name")),
    GR("fast_vn_mesh", mesh_parameters, RESULT_NODE, gr_mesh, "The same as gr.vn_mesh.", VN_FORM("material"),
       VN_FORM("name")),
    GR("geometry", geometry_parameters, RESULT_NODE, gr_geometry, "A node with the shape and material of a primitive.",
       "name primitive"),
    GR("csg_union", csg_parameters, RESULT_NODE, gr_union,
       "The union of solids: points in any operand. It has no inner walls.", "name a b", "a b"),
    GR("csg_difference", csg_parameters, RESULT_NODE, gr_difference,
       "The difference of solids: points in the first operand and in none of the others.", "name a b", "a b"),
    GR("csg_intersection", csg_parameters, RESULT_NODE, gr_intersection,
       "The intersection of solids: points in all operands.", "name a b", "a b"),
    GR("csg_merge", csg_parameters, RESULT_NODE, gr_union,
       "The same as gr.csg_union, which has no inner walls either; a plain node keeps them.", "name a b", "a b"),
    GR("csg_inverse", inverse_parameters, RESULT_NODE, gr_inverse,
       "The complement of a solid: the same surface, turned inside out.", "name a", "a"),
    GR("union", csg_parameters, RESULT_NODE, gr_union, "The same as gr.csg_union.", "name a b", "a b"),
    GR("difference", csg_parameters, RESULT_NODE, gr_difference, "The same as gr.csg_difference.", "name a b", "a b"),
    GR("intersection", csg_parameters, RESULT_NODE, gr_intersection, "The same as gr.csg_intersection.", "name a b",
       "a b"),
    GR("merge", csg_parameters, RESULT_NODE, gr_union, "The same as gr.csg_merge.", "name a b", "a b"),
    GR("inverse", inverse_parameters, RESULT_NODE, gr_inverse, "The same as gr.csg_inverse.", "name a", "a"),
    GR("clipped_by", clipped_parameters, RESULT_NODE, gr_clipped_by,
       "The part of the surfaces of an object that is inside a solid: cut open, without caps. It is not a CSG operand.",
       "name object by", "object by"),
    GR("bounded_by", bounded_parameters, RESULT_NODE, gr_bounded_by,
       "The object, with the hint that a solid contains it. This makes objects with a large bounding box faster.",
       "name object by", "object by"),
};

static const struct script_function material_rows[] = {
    GR("material", material_parameters, RESULT_MATERIAL, gr_material, "A Phong material.", "kd ks? shininess?"),
    GR("rr_material", rr_parameters, RESULT_MATERIAL, gr_rr_material, "A Phong material that reflects and refracts.",
       "kd ks shininess reflect refract ior"),
    GR("marble_pnd_material", marble_parameters, RESULT_MATERIAL, gr_marble, "Marble over another material.",
       "material f multiplier vein_frequency interp mix"),
    GR("wood_pnd_material", wood_parameters, RESULT_MATERIAL, gr_wood, "Wood over another material.",
       "material f density interp mix"),
    GR("td_cube_material", image_parameters, RESULT_MATERIAL, gr_td_cube,
       "An image on each side of the unit cube, over another material.", "material png"),
    GR("td_sphere_material", image_parameters, RESULT_MATERIAL, gr_td_sphere,
       "An image around the unit sphere, over another material.", "material png"),
    GR("difresnel_material", fresnel_parameters, RESULT_MATERIAL, gr_fresnel,
       "A dielectric: reflects and refracts by Fresnel's equations.", "material"),
    GR("difresneld_material", fresnel_parameters, RESULT_MATERIAL, gr_fresnel, "The same as gr.difresnel_material.",
       "material"),
    GR("texture", texture_parameters, RESULT_TEXTURE, gr_texture,
       "An image texture for node:set_texture and for inputs of gr.material.", "file"),
    GR("bump", bump_parameters, RESULT_TEXTURE, gr_bump, "A bump map or normal map for node:set_bump.", "file height?"),
    GR("image_material", image_over_parameters, RESULT_MATERIAL, gr_image_material,
       "An image mapped by the texture coordinates of the shape, over another material.", "material image"),
    GR("bump_material", bump_over_parameters, RESULT_MATERIAL, gr_bump_material,
       "A bump map or normal map over another material.", "material image height?"),
    GR("glyphs", glyphs_parameters, RESULT_GLYPHS, gr_glyphs,
       "Outlines of a line of text, in ems: a list of letters with code, x, advance, missing and contours (cubic, for "
       "gr.prism), and the fields width, ascender, descender and line.",
       "font text"),

};

static const struct script_function other_rows[] = {
    GR("change_node", change_node_parameters, RESULT_NOTHING, gr_change_node,
       "Transforms a node in all later pictures. The window saves edits as a file of such calls; require loads it.",
       "name serial matrix"),
    GR("change_delete", change_delete_parameters, RESULT_NOTHING, gr_change_delete,
       "Removes a node and its children from all later pictures.", "name serial"),
    GR("change_add", change_add_parameters, RESULT_NOTHING, gr_change_add,
       "Adds a node to all later pictures; gr.change_node places it.", "name serial shape colour? source?"),
    GR("change_material", change_material_parameters, RESULT_NOTHING, gr_change_material,
       "Changes the colour of a material in all later pictures.", "serial colour"),
    GR("change_look", change_look_parameters, RESULT_NOTHING, gr_change_look,
       "Changes an input of a base material in all later pictures.", "serial part value"),
    GR("change_own", change_own_parameters, RESULT_NOTHING, gr_change_own,
       "Gives a shape its own copy of its material in all later pictures. The copies are numbered 2147483647, "
       "2147483646 and so on.",
       "name serial like?"),
    GR("change_light", change_light_parameters, RESULT_NOTHING, gr_change_light,
       "Moves, rotates, scales or recolours a light in all later pictures.", "number move factor? linear? colour?"),
    GR("change_delete_light", change_delete_light_parameters, RESULT_NOTHING, gr_change_delete_light,
       "Removes a light from all later pictures.", "number"),
    GR("change_add_light", change_add_light_parameters, RESULT_NOTHING, gr_change_add_light,
       "Adds a point light to all later pictures.", "position colour"),
    GR("change_copy_light", change_copy_light_parameters, RESULT_NOTHING, gr_change_copy_light,
       "Adds a copy of a light to all later pictures.", "number move factor?"),
    GR("change_view", change_view_parameters, RESULT_NOTHING, gr_change_view, "Changes the camera of a picture.",
       "picture eye view up fov"),
    GR("change_exposure", change_exposure_parameters, RESULT_NOTHING, gr_change_exposure,
       "Changes the exposure of a picture.", "picture stops"),

    GR("sun_light", sun_light_parameters, RESULT_LIGHT, gr_sun_light,
       "A directional light from the position of the sun.", "sun colour"),
    GR("sky_faces", sky_faces_parameters, RESULT_SKY, gr_sky_faces,
       "A sky of six pictures on a cube: front is +z, right is -x, back is -z, left is +x.",
       "front right back left top bottom"),
    GR("sky_cross", sky_cross_parameters, RESULT_SKY, gr_sky_cross, "A sky from a 4 x 3 cross of images.", "image"),
    GR("sky_map", sky_map_parameters, RESULT_SKY, gr_sky_map, "A sky from one picture of the whole sphere.", "image"),
    GR("sky_gradient", sky_gradient_parameters, RESULT_SKY, gr_sky_gradient, "A sky with colours by height.", "stops"),
    GR("sky_function", sky_function_parameters, RESULT_SKY, gr_sky_function,
       "A sky whose colour is a function of the direction.", "f"),
    GR("clear_sky", clear_sky_parameters, RESULT_SKY, gr_clear_sky,
       "The clear sky model of Preetham, Shirley and Smits (1999).", "sun turbidity?"),

    GR("uniform_fog", fog_parameters, RESULT_FOG, gr_fog, "Fog of constant density.", "density colour?"),
    GR("linear_fog", linear_fog_parameters, RESULT_FOG, gr_linear_fog,
       "Fog whose transmittance falls linearly with distance.", "near far colour?"),
    GR("height_fog", height_fog_parameters, RESULT_FOG, gr_height_fog,
       "Fog whose density falls exponentially with height.", "density base scale colour?"),
    GR("fog_profile", fog_profile_parameters, RESULT_FOG, gr_fog_profile, "Fog with a density by height.",
       "profile colour?"),
    GR("fog_grid", fog_grid_parameters, RESULT_FOG, gr_fog_grid, "Fog in the cells of a box; no fog outside.",
       "corner size cells densities colour?"),
    GR("fog_field", fog_field_parameters, RESULT_FOG, gr_fog_field,
       "Fog in a box whose density is a function of the point; no fog outside.", "corner size density colour?"),

    GR("render", render_parameters, RESULT_NOTHING, gr_render, "Renders a picture into a file.",
       "node file" RENDER_TAIL),
    GR("render_skybox", render_parameters, RESULT_NOTHING, gr_render, "The same as gr.render, with a sky picture.",
       "node file sky" RENDER_TAIL),
    GR("transform_order", order_parameters, RESULT_NOTHING, gr_transform_order,
       "Selects how scale, rotate and translate compose in this script.", "order"),

    NODE("add_child", child_parameters, RESULT_SELF, gr_add_child, "Adds a child to this node.", "node"),
    NODE("bounds", self_parameters, RESULT_BOUNDS, gr_bounds,
         "Returns the bounding box of this node and its children, with its own transforms: smallest and largest x, y, "
         "z.",
         ""),
    NODE("faces", self_parameters, RESULT_FACES, gr_faces,
         "Returns the vertices and faces of a mesh, in object space, as gr.mesh accepts them.", ""),
    NODE("set_material", set_material_parameters, RESULT_SELF, gr_set_material, "Sets the material of a shape.",
         "material"),
    NODE("set_texture", set_texture_parameters, RESULT_SELF, gr_set_texture, "Replaces kd of a shape by an image.",
         "texture"),
    NODE("set_bump", set_bump_parameters, RESULT_SELF, gr_set_bump, "Sets the bump map of a shape.", "bump"),
    NODE("scale", scale_parameters, RESULT_SELF, gr_scale, "Scales this node.", "x y z", "vector"),
    NODE("rotate", rotate_parameters, RESULT_SELF, gr_rotate, "Rotates this node about an axis.", "axis angle"),
    NODE("velocity", velocity_parameters, RESULT_SELF, gr_velocity,
         "Sets the velocity of this node per second while the shutter is open; its transforms are its pose at time 0.",
         "x y z", "vector"),
    NODE("moves_to", moves_to_parameters, RESULT_SELF, gr_moves_to,
         "Moves this node from its own pose at time 0 to the pose of another node at time 1, on the shorter rotation.",
         "node"),
    NODE("spin", spin_parameters, RESULT_SELF, gr_spin,
         "Rotates this node at a constant rate about an axis through the origin of its own space, before its "
         "transforms.",
         "axis degrees", "direction degrees"),
    NODE("reset", self_parameters, RESULT_SELF, gr_reset,
         "Removes the transforms of this node, so that an animation can set new ones in each frame.", ""),
    NODE("pose", pose_parameters, RESULT_SELF, gr_pose,
         "Replaces the transforms of this node by a scale, a rotation and a translation, as gr.keys interpolates them.",
         "translate rotate? scale?"),
    NODE("rotate_axis", rotate_axis_parameters, RESULT_SELF, gr_rotate_axis, "Rotates this node about any direction.",
         "axis angle"),
    NODE("rotate_quat", rotate_quat_parameters, RESULT_SELF, gr_rotate_quat, "Rotates this node by a quaternion.",
         "w x y z", "quaternion"),
    NODE("translate", translate_parameters, RESULT_SELF, gr_translate, "Translates this node.", "x y z", "vector"),
    NODE("render", render_parameters, RESULT_NOTHING, gr_render, "The same as gr.render with this node.",
         "file" RENDER_TAIL),
};

static const struct function_rows node_functions = {node_rows, COUNT(node_rows)};
static const struct function_rows material_functions = {material_rows, COUNT(material_rows)};
static const struct function_rows other_functions = {other_rows, COUNT(other_rows)};
/* In the order of the manual. */
static const struct function_rows *const parts[] = {
    &node_functions,     &shape_functions,   &swept_functions, &displace_functions, &texture_functions,
    &material_functions, &layered_functions, &light_functions, &other_functions,    &frame_functions};

int function_count(void) {
    int count = 0;
    for (int part = 0; part < COUNT(parts); part++)
        count += parts[part]->count;
    return count;
}

const struct script_function *function_at(int index) {
    int part = 0;
    for (; index >= parts[part]->count; part++)
        index -= parts[part]->count;
    return &parts[part]->rows[index];
}

const struct script_function *function_find(enum owner owner, const char *name) {
    for (int i = 0; i < function_count(); i++) {
        const struct script_function *function = function_at(i);
        if (function->owner == owner && strcmp(function->name, name) == 0)
            return function;
    }
    return NULL;
}

/* Likewise. */
static const struct value_functions *const value_parts[] = {&vector_functions, &display_colour_functions,
                                                            &key_functions, &symbol_functions};

const struct value_function *value_function_at(size_t index) {
    for (int part = 0; part < COUNT(value_parts); part++) {
        size_t count = (size_t)value_parts[part]->count;
        if (index < count)
            return &value_parts[part]->functions[index];
        index -= count;
    }
    return NULL;
}
