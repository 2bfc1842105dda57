/* The table of gr functions. One row a function; everything people read about it and every check of its arguments comes
 * from here. The rows of shapes and lights are in the files that make them. Facts: SPEC parts 1 and 2. */
#include "script/table.h"
#include "base/unreachable.h"

#include "render/settings.h"
#include "scene/change.h"
#include "script/table_rows.h"

#include <assert.h>
#include <string.h>

#define CHILDREN                                                                                                       \
    { "children", KIND_NODES, OPTIONAL, ANY, NULL, "{}", "Nodes placed under this one." }

static const struct parameter group_parameters[] = {
    [GROUP_NAME] = {"name", KIND_TEXT, OPTIONAL, ANY, NULL, "'node'", NAME_HELP},
    [GROUP_CHILDREN] = CHILDREN,
};

static const struct parameter instances_parameters[] = {
    [INSTANCES_NAME] = {"name", KIND_TEXT, OPTIONAL, ANY, NULL, "'instances'", NAME_HELP},
    [INSTANCES_OF] = {"of", KIND_NODE, 0, ANY, NULL, NULL, "What stands in all the places."},
    [INSTANCES_AT] = {"at", KIND_ROWS, 0, ANY, NULL, NULL,
                      "The places, {x, y, z}, or the first three rows of matrices, 12 numbers each."},
    [INSTANCES_TURN] = {"turn", KIND_NUMBERS, OPTIONAL, ANY, "degrees", "0",
                        "Turn about axis before it is moved to its place, for each or one for all."},
    [INSTANCES_AXIS] = {"axis", KIND_AXIS, OPTIONAL, 0, 0, "x y z", NULL, "'y'", "Axis of turn."},
    [INSTANCES_SIZE] = {"size", KIND_NUMBERS, OPTIONAL | LOW_OPEN, ABOVE(0), NULL, "1",
                        "Factor by which it is scaled first, for each or one for all."},
};

static const struct parameter joint_parameters[] = {
    [JOINT_NAME] = {"name", KIND_TEXT, OPTIONAL, ANY, NULL, "'joint'", NAME_HELP},
    [JOINT_X] = {"x", KIND_TRIPLE, 0, ANY, "degrees", NULL,
                 "Smallest, initial and largest angle about x; drawn at the initial one."},
    [JOINT_Y] = {"y", KIND_TRIPLE, 0, ANY, "degrees", NULL, "The same about y."},
    [JOINT_CHILDREN] = CHILDREN,
};

static const struct parameter sphere_parameters[] = {
    [SPHERE_NAME] = {"name", KIND_TEXT, OPTIONAL, ANY, NULL, "'sphere'", NAME_HELP},
    [SPHERE_MATERIAL] = {"material", KIND_MATERIAL, OPTIONAL | GHOST_IS_NONE, ANY, NULL, "plain gray", MATERIAL_HELP},
    [SPHERE_CENTRE] = {"centre", KIND_POINT, OPTIONAL, ANY, NULL, "{0, 0, 0}", "Centre."},
    [SPHERE_RADIUS] = {"radius", KIND_NUMBER, OPTIONAL | LOW_OPEN, ABOVE(0), NULL, "1", "Radius."},
};

static const struct parameter cube_parameters[] = {
    [CUBE_NAME] = {"name", KIND_TEXT, OPTIONAL, ANY, NULL, "'cube'", NAME_HELP},
    [CUBE_MATERIAL] = {"material", KIND_MATERIAL, OPTIONAL | GHOST_IS_NONE, ANY, NULL, "plain gray", MATERIAL_HELP},
    [CUBE_CORNER] = {"corner", KIND_POINT, OPTIONAL, ANY, NULL, "{0, 0, 0}",
                     "The corner with the smallest coordinates."},
    [CUBE_SIZE] = {"size", KIND_SIZE, OPTIONAL | NOT_ZERO, ANY, NULL, "1",
                   "Length of the edges, one number or three; a negative one reaches the other way."},
};

static const struct parameter mesh_parameters[] = {
    [MESH_NAME] = {"name", KIND_TEXT, OPTIONAL, ANY, NULL, "'mesh'", NAME_HELP},
    [MESH_MATERIAL] = {"material", KIND_MATERIAL, OPTIONAL | GHOST_IS_NONE, ANY, NULL, "plain gray", MATERIAL_HELP},
    [MESH_FILE] = {"file", KIND_FILE, OPTIONAL, ANY, NULL, NULL,
                   "An OBJ, PLY, STL, glTF or GLB file, instead of verts and faces."},
    [MESH_VERTS] = {"verts", KIND_POINTS, OPTIONAL, ANY, NULL, NULL, "The vertices."},
    [MESH_NORMALS] = {"normals", KIND_POINTS, OPTIONAL, ANY, NULL, "none: flat", "Vertex normals, of any length."},
    [MESH_FACES] = {"faces", KIND_FACES, OPTIONAL, ANY, NULL, NULL, "Polygons: tuples of 0-based indices into verts."},
    [MESH_FACE_NORMALS] = {"face_normals", KIND_FACES, OPTIONAL, ANY, NULL, "faces",
                           "For each face a tuple of 0-based indices into normals."},
    [MESH_UVS] = {"uvs", KIND_PAIRS, OPTIONAL, ANY, NULL, "none", "Places on an image, {u, v}; v counts from below."},
    [MESH_FACE_UVS] = {"face_uvs", KIND_FACES, OPTIONAL, ANY, NULL, "faces",
                       "For each face a tuple of 0-based indices into uvs."},
    [MESH_SMOOTH] = {"smooth", KIND_NUMBER, OPTIONAL, BETWEEN(0, 180), "degrees", "as given",
                     "Faces that meet at less than this angle are one smooth surface; 0: all are flat."},
    [MESH_WELD] = {"weld", KIND_BOOLEAN, OPTIONAL, ANY, NULL, "false", "Whether vertices in one place become one."},
    [MESH_FLIP] = {"flip", KIND_BOOLEAN, OPTIONAL, ANY, NULL, "false", "Whether the faces are turned round."},
    [MESH_CULL] = {"cull", KIND_CHOICE, OPTIONAL, 0, 0, LIST_BLANKS(NODE_CULLS), NULL, "'none'",
                   "Which faces no ray meets: those seen from behind, or from the front."},
    [MESH_MATERIALS] = {"materials", KIND_MATERIALS, OPTIONAL, ANY, NULL, "the file's",
                        "Materials by the names that the file gives its parts, or with face_materials a list."},
    [MESH_FACE_MATERIALS] = {"face_materials", KIND_NUMBERS, OPTIONAL, ANY, NULL, "material for all",
                             "With faces: for each the number of its entry in materials, from 1."},
};

#define SERIAL_HELP                                                                                                    \
    "Which one, by order of creation: the first is 0, what was added in a window counts down from 4294967295."
#define CHANGED_NAME "Name of the node; a node of another name is not meant."
#define SERIALS BETWEEN(0, 4294967295.0)
#define PICTURE_HELP "The picture that it is for, by the name that gr.render gives it."

static const struct parameter change_node_parameters[] = {
    [CHANGENODE_NAME] = {"name", KIND_TEXT, 0, ANY, NULL, NULL, CHANGED_NAME},
    [CHANGENODE_SERIAL] = {"serial", KIND_WHOLE, 0, SERIALS, NULL, NULL, SERIAL_HELP},
    [CHANGENODE_MATRIX] = {"matrix", KIND_NUMBERS, 0, ANY, NULL, NULL,
                           "Three rows of a matrix, 12 numbers: where it goes from where its own transforms put it, in "
                           "the space of its parent."},
};

static const struct parameter change_delete_parameters[] = {
    [CHANGEGONE_NAME] = {"name", KIND_TEXT, 0, ANY, NULL, NULL, CHANGED_NAME},
    [CHANGEGONE_SERIAL] = {"serial", KIND_WHOLE, 0, SERIALS, NULL, NULL, SERIAL_HELP},
};

static const struct parameter change_add_parameters[] = {
    [CHANGEADD_NAME] = {"name", KIND_TEXT, 0, ANY, NULL, NULL, "Name of the node that it goes under."},
    [CHANGEADD_SERIAL] = {"serial", KIND_WHOLE, 0, SERIALS, NULL, NULL, SERIAL_HELP},
    [CHANGEADD_SHAPE] = {"shape", KIND_CHOICE, 0, 0, 0, LIST_BLANKS(ADDED), NULL, NULL,
                         "What is added, of about the size of a ball of radius 1, or a copy of a node."},
    [CHANGEADD_COLOUR] = {"colour", KIND_COLOUR, OPTIONAL, ANY, NULL, "{0.7, 0.7, 0.7}", "Its colour."},
    [CHANGEADD_SOURCE] = {"source", KIND_WHOLE, OPTIONAL, SERIALS, NULL, "0",
                          "For a copy: the node that is shown once more."},
};

static const struct parameter change_material_parameters[] = {
    [CHANGEMATERIAL_SERIAL] = {"serial", KIND_WHOLE, 0, SERIALS, NULL, NULL,
                               "Which one, by order of creation: the first is 1."},
    [CHANGEMATERIAL_COLOUR] = {"colour", KIND_COLOUR, 0, ANY, NULL, NULL, "The new diffuse colour of its base."},
};

static const struct parameter change_look_parameters[] = {
    [CHANGELOOK_SERIAL] = {"serial", KIND_WHOLE, 0, SERIALS, NULL, NULL,
                           "Which material, by order of creation: the first is 1."},
    [CHANGELOOK_PART] = {"part", KIND_CHOICE, 0, 0, 0, LIST_BLANKS(LOOK_PART_LIST), NULL, NULL,
                         "What of its base, by the name that gr.material has for it."},
    [CHANGELOOK_VALUE] = {"value", KIND_NUMBERS, 0, ANY, NULL, NULL, "Three numbers for a colour, else one."},
};

static const struct parameter change_own_parameters[] = {
    [CHANGEOWN_NAME] = {"name", KIND_TEXT, 0, ANY, NULL, NULL, CHANGED_NAME},
    [CHANGEOWN_SERIAL] = {"serial", KIND_WHOLE, 0, SERIALS, NULL, NULL, SERIAL_HELP},
    [CHANGEOWN_LIKE] = {"like", KIND_WHOLE, OPTIONAL, SERIALS, NULL, "0",
                        "A material by order of creation, for a shape that has none itself; 0: plain gray."},
};

static const struct parameter change_light_parameters[] = {
    [CHANGELIGHT_NUMBER] = {"number", KIND_WHOLE, 0, 1, 4294967295.0, NULL, NULL, NULL,
                            "Its place in the list of gr.render, from 1."},
    [CHANGELIGHT_MOVE] = {"move", KIND_TRIPLE, 0, ANY, NULL, NULL, "The way it is moved."},
    [CHANGELIGHT_FACTOR] = {"factor", KIND_TRIPLE, OPTIONAL, ANY, NULL, "{1, 1, 1}",
                            "What its colour is multiplied by."},
    [CHANGELIGHT_TURN] = {"linear", KIND_NUMBERS, OPTIONAL, ANY, NULL, "none",
                          "Three rows of a matrix, 9 numbers: how it is turned and sized about its place."},
    [CHANGELIGHT_COLOUR] = {"colour", KIND_COLOUR, OPTIONAL, ANY, NULL, "its own",
                            "Another colour, before it is multiplied."},
};

static const struct parameter change_delete_light_parameters[] = {
    [CHANGEDARK_NUMBER] = {"number", KIND_WHOLE, 0, 1, 4294967295.0, NULL, NULL, NULL,
                           "Its place in the list of gr.render, from 1."},
};

static const struct parameter change_add_light_parameters[] = {
    [CHANGENEWLIGHT_POSITION] = {"position", KIND_POINT, 0, ANY, NULL, NULL, "Where it is."},
    [CHANGENEWLIGHT_COLOUR] = {"colour", KIND_COLOUR, 0, ANY, NULL, NULL, "Its colour."},
};

static const struct parameter change_copy_light_parameters[] = {
    [CHANGECOPYLIGHT_NUMBER] = {"number", KIND_WHOLE, 0, 1, 4294967295.0, NULL, NULL, NULL,
                                "Its place in the list of gr.render, from 1."},
    [CHANGECOPYLIGHT_MOVE] = {"move", KIND_TRIPLE, 0, ANY, NULL, NULL, "How far the copy stands from it."},
    [CHANGECOPYLIGHT_FACTOR] = {"factor", KIND_TRIPLE, OPTIONAL, ANY, NULL, "{1, 1, 1}",
                                "What the copy's colour is multiplied by."},
};

static const struct parameter change_view_parameters[] = {
    [CHANGEVIEW_PICTURE] = {"picture", KIND_TEXT, 0, ANY, NULL, NULL, PICTURE_HELP},
    [CHANGEVIEW_EYE] = {"eye", KIND_POINT, 0, ANY, NULL, NULL, "Where the camera is."},
    [CHANGEVIEW_VIEW] = {"view", KIND_DIRECTION, 0, ANY, NULL, NULL, "The direction it looks in."},
    [CHANGEVIEW_UP] = {"up", KIND_DIRECTION, 0, ANY, NULL, NULL, "What is up in the picture."},
    [CHANGEVIEW_FOV] = {"fov", KIND_NUMBER, LOW_OPEN | HIGH_OPEN, BETWEEN(0, 180), "degrees", NULL,
                        "Its full vertical angle."},
};

static const struct parameter change_exposure_parameters[] = {
    [CHANGEEXPOSURE_PICTURE] = {"picture", KIND_TEXT, 0, ANY, NULL, NULL, PICTURE_HELP},
    [CHANGEEXPOSURE_STOPS] = {"stops", KIND_NUMBER, 0, BETWEEN(-100, 100), "stops", NULL,
                              "Its exposure in the place of what the script says."},
};

static const struct parameter self_parameters[] = {{"self", KIND_NODE, 0, ANY, NULL, NULL, "The node."}};

static const struct parameter geometry_parameters[] = {
    [GEOMETRY_NAME] = {"name", KIND_TEXT, OPTIONAL, ANY, NULL, "'geometry'", NAME_HELP},
    [GEOMETRY_PRIMITIVE] = {"primitive", KIND_NODE, 0, ANY, NULL, NULL, "A primitive, for instance gr.sphere(mat)."},
    [GEOMETRY_MATERIAL] = {"material", KIND_MATERIAL, OPTIONAL | GHOST_IS_NONE, ANY, NULL, "the primitive's",
                           MATERIAL_HELP},
};

static const struct parameter csg_parameters[] = {
    [CSG_NAME] = {"name", KIND_TEXT, OPTIONAL, ANY, NULL, "'csg'", NAME_HELP},
    [CSG_A] = {"a", KIND_NODE, GHOST_IS_NONE, ANY, NULL, NULL,
               "A closed solid; a group counts as the union of what is under it."},
    [CSG_B] = {"b", KIND_NODE, GHOST_IS_NONE, ANY, NULL, NULL, "The other one."},
    [CSG_OPERANDS] = {"operands", KIND_NODES, OPTIONAL | REST, ANY, NULL, NULL,
                      "Any number of solids: as further arguments, as a list, or without names in the table, with or "
                      "without a and b before them."},
};

static const struct parameter inverse_parameters[] = {
    [INVERSE_NAME] = {"name", KIND_TEXT, OPTIONAL, ANY, NULL, "'inverse'", NAME_HELP},
    [INVERSE_A] = {"a", KIND_NODE, GHOST_IS_NONE, ANY, NULL, NULL,
                   "A closed solid; a group counts as the union of what is under it."},
};

static const struct parameter clipped_parameters[] = {
    [CLIPPED_NAME] = {"name", KIND_TEXT, OPTIONAL, ANY, NULL, "'clipped'", NAME_HELP},
    [CLIPPED_OBJECT] = {"object", KIND_NODE, GHOST_IS_NONE, ANY, NULL, NULL,
                        "What is seen: a shape or a group of them."},
    [CLIPPED_BY] = {"by", KIND_NODE, GHOST_IS_NONE, ANY, NULL, NULL, "A closed solid: what is inside of it stays."},
};

static const struct parameter bounded_parameters[] = {
    [CLIPPED_NAME] = {"name", KIND_TEXT, OPTIONAL, ANY, NULL, "'bounded'", NAME_HELP},
    [CLIPPED_OBJECT] = {"object", KIND_NODE, GHOST_IS_NONE, ANY, NULL, NULL,
                        "What is seen: a shape or a group of them."},
    [CLIPPED_BY] = {"by", KIND_NODE, GHOST_IS_NONE, ANY, NULL, NULL,
                    "A closed solid that nothing of it sticks out of; what does may be seen or not."},
};

static const struct parameter order_parameters[] = {
    {"order", KIND_CHOICE, 0, 0, 0, LIST_BLANKS(TRANSFORM_ORDERS), NULL, NULL,
     "new: calls act as they are written; old: the last call acts first; separate: scale, then rotate, then "
     "translate."},
};

#define SELF_PARAMETER [SELF] = {"self", KIND_NODE, 0, ANY, NULL, NULL, "The node."}

static const struct parameter child_parameters[] = {
    SELF_PARAMETER,
    [CHILD_NODE] = {"node", KIND_NODE, 0, ANY, NULL, NULL, "The child; under several parents it is an instance."},
};

static const struct parameter set_material_parameters[] = {
    SELF_PARAMETER,
    [SET_MATERIAL] = {"material", KIND_MATERIAL, 0, ANY, NULL, NULL, MATERIAL_HELP},
};

static const struct parameter set_texture_parameters[] = {
    SELF_PARAMETER,
    [SET_TEXTURE] = {"texture", KIND_IMAGE, 0, ANY, NULL, NULL, "A texture, or the name of a PNG or JPEG file."},
};

static const struct parameter set_bump_parameters[] = {
    SELF_PARAMETER,
    [SET_BUMP] = {"bump", KIND_IMAGE, OR_TEXTURE, ANY, NULL, NULL,
                  "What gr.bump made, or the name of a PNG or JPEG file."},
};

static const struct parameter translate_parameters[] = {
    SELF_PARAMETER,
    [STEP_X] = {"x", KIND_NUMBER, 0, ANY, NULL, NULL, "How far along x."},
    [STEP_Y] = {"y", KIND_NUMBER, 0, ANY, NULL, NULL, "How far along y."},
    [STEP_Z] = {"z", KIND_NUMBER, 0, ANY, NULL, NULL, "How far along z."},
    [STEP_VECTOR] = {"vector", KIND_TRIPLE, 0, ANY, NULL, NULL, "All three in one table."},
};

static const struct parameter velocity_parameters[] = {
    SELF_PARAMETER,
    [STEP_X] = {"x", KIND_NUMBER, 0, ANY, NULL, NULL, "How far along x in a unit of time, as the parent measures."},
    [STEP_Y] = {"y", KIND_NUMBER, 0, ANY, NULL, NULL, "How far along y."},
    [STEP_Z] = {"z", KIND_NUMBER, 0, ANY, NULL, NULL, "How far along z."},
    [STEP_VECTOR] = {"vector", KIND_TRIPLE, 0, ANY, NULL, NULL, "All three in one table."},
};

static const struct parameter moves_to_parameters[] = {
    SELF_PARAMETER,
    [MOVES_TO_NODE] = {"node", KIND_NODE, 0, ANY, NULL, NULL,
                       "A node whose own transforms say where this one is at time 1; it need not be in the scene."},
};

static const struct parameter scale_parameters[] = {
    SELF_PARAMETER,
    [STEP_X] = {"x", KIND_NUMBER, 0, ANY, NULL, NULL, "Factor along x."},
    [STEP_Y] = {"y", KIND_NUMBER, 0, ANY, NULL, NULL, "Factor along y."},
    [STEP_Z] = {"z", KIND_NUMBER, 0, ANY, NULL, NULL, "Factor along z."},
    [STEP_VECTOR] = {"vector", KIND_TRIPLE, 0, ANY, NULL, NULL, "All three in one table."},
};

static const struct parameter rotate_parameters[] = {
    SELF_PARAMETER,
    [ROTATE_AXIS] = {"axis", KIND_AXIS, 0, 0, 0, "x y z", NULL, NULL, "The axis, in either case."},
    [ROTATE_ANGLE] = {"angle", KIND_NUMBER, 0, ANY, "degrees", NULL,
                      "How far, counterclockwise seen from the axis' tip."},
};

static const struct parameter rotate_axis_parameters[] = {
    SELF_PARAMETER,
    [ROTATE_AXIS] = {"axis", KIND_DIRECTION, 0, ANY, NULL, NULL, "The axis: a direction of any length but 0."},
    [ROTATE_ANGLE] = {"angle", KIND_NUMBER, 0, ANY, "degrees", NULL,
                      "How far, counterclockwise seen from the axis' tip."},
};

static const struct parameter rotate_quat_parameters[] = {
    SELF_PARAMETER,
    [QUAT_W] = {"w", KIND_NUMBER, 0, ANY, NULL, NULL, "The cosine of half the angle, times any length but 0."},
    [QUAT_X] = {"x", KIND_NUMBER, 0, ANY, NULL, NULL, "The axis times the sine of half the angle, times that length."},
    [QUAT_Y] = {"y", KIND_NUMBER, 0, ANY, NULL, NULL, "The same along y."},
    [QUAT_Z] = {"z", KIND_NUMBER, 0, ANY, NULL, NULL, "The same along z."},
    [QUAT_TABLE] = {"quaternion", KIND_QUATERNION, 0, ANY, NULL, NULL, "All four in one table."},
};

#define KD                                                                                                             \
    { "kd", KIND_COLOUR, OR_TEXTURE, ANY, NULL, NULL, "Colour of diffuse and ambient light." }
#define KS                                                                                                             \
    {                                                                                                                  \
        "ks", KIND_COLOUR, OPTIONAL | OR_TEXTURE, ANY, NULL, "{0, 0, 0}",                                              \
            "Colour of highlights, filter of secondary rays."                                                          \
    }
#define SHININESS                                                                                                      \
    { "shininess", KIND_NUMBER, OPTIONAL | OR_TEXTURE, ABOVE(0), NULL, "1", "Exponent of the highlight." }
#define TWO_SIDED                                                                                                      \
    { "two_sided", KIND_BOOLEAN, OPTIONAL, ANY, NULL, "false", "Whether faces seen from behind are lit as well." }

#define SURFACE_FIELDS                                                                                                 \
    [PHONG_HIGHLIGHT] = {"highlight",                                                                                  \
                         KIND_CHOICE,                                                                                  \
                         OPTIONAL,                                                                                     \
                         0,                                                                                            \
                         0,                                                                                            \
                         LIST_BLANKS(HIGHLIGHTS),                                                                      \
                         NULL,                                                                                         \
                         "specular of the render",                                                                     \
                         "The form of its highlight."},                                                                \
    [PHONG_LIT] = {"lit",                                                                                              \
                   KIND_BOOLEAN,                                                                                       \
                   OPTIONAL,                                                                                           \
                   ANY,                                                                                                \
                   NULL,                                                                                               \
                   "true",                                                                                             \
                   "Whether light is looked for; false: kd is shown as it is."},                                       \
    [PHONG_EMISSION] = {"emission",                                                                                    \
                        KIND_COLOUR,                                                                                   \
                        OPTIONAL | OR_TEXTURE,                                                                         \
                        ANY,                                                                                           \
                        NULL,                                                                                          \
                        "{0, 0, 0}",                                                                                   \
                        "Light of its own, added to what it reflects."},                                               \
    [PHONG_ROUGHNESS] = {"roughness",                                                                                  \
                         KIND_NUMBER,                                                                                  \
                         OPTIONAL | OR_TEXTURE,                                                                        \
                         BETWEEN(0, 1),                                                                                \
                         NULL,                                                                                         \
                         "0",                                                                                          \
                         "Of reflection and refraction: 0 is polished."},                                              \
    [PHONG_GLOSSY_SAMPLES] = {"glossy_samples",                                                                        \
                              KIND_WHOLE,                                                                              \
                              OPTIONAL,                                                                                \
                              BETWEEN(1, 64),                                                                          \
                              NULL,                                                                                    \
                              "4",                                                                                     \
                              "N x N rays where it is rough; one ray after another rough surface."},                   \
    [PHONG_ABSORPTION] = {"absorption",                                                                                \
                          KIND_COLOUR,                                                                                 \
                          OPTIONAL,                                                                                    \
                          ABOVE(0),                                                                                    \
                          NULL,                                                                                        \
                          "{0, 0, 0}",                                                                                 \
                          "Inside, light fades by exp(-absorption * distance)."},                                      \
    [PHONG_OPACITY] = {"opacity",                                                                                      \
                       KIND_NUMBER,                                                                                    \
                       OPTIONAL | OR_TEXTURE,                                                                          \
                       BETWEEN(0, 1),                                                                                  \
                       NULL,                                                                                           \
                       "1",                                                                                            \
                       "How much of the surface is there; the rest is a hole."},                                       \
    [PHONG_METALNESS] = {"metalness",                                                                                  \
                         KIND_NUMBER,                                                                                  \
                         OPTIONAL | OR_TEXTURE,                                                                        \
                         BETWEEN(0, 1),                                                                                \
                         NULL,                                                                                         \
                         "0",                                                                                          \
                         "The share of kd that colours highlights and mirrored light instead."},                       \
    [PHONG_BUMP] = {"bump",                                                                                            \
                    KIND_IMAGE,                                                                                        \
                    OPTIONAL | OR_TEXTURE,                                                                             \
                    ANY,                                                                                               \
                    NULL,                                                                                              \
                    "none",                                                                                            \
                    "Heights: what gr.bump made, a file or a texture."}

static const struct parameter material_parameters[] = {
    [PHONG_KD] = KD,
    [PHONG_KS] = KS,
    [PHONG_SHININESS] = SHININESS,
    [PHONG_REFLECT] = {"reflect", KIND_NUMBER, OPTIONAL | OR_TEXTURE, BETWEEN(0, 1), NULL, "0",
                       "Amount of reflected light."},
    [PHONG_REFRACT] = {"refract", KIND_NUMBER, OPTIONAL | OR_TEXTURE, BETWEEN(0, 1), NULL, "0",
                       "Amount of refracted light."},
    [PHONG_IOR] = {"ior", KIND_NUMBER, OPTIONAL, ABOVE(1), NULL, "none", "Index of refraction of the inside."},
    [PHONG_TWO_SIDED] = TWO_SIDED,
    SURFACE_FIELDS,
};

static const struct parameter rr_parameters[] = {
    [PHONG_KD] = KD,
    [PHONG_KS] = KS,
    [PHONG_SHININESS] = SHININESS,
    [PHONG_REFLECT] = {"reflect", KIND_NUMBER, OPTIONAL | OR_TEXTURE, BETWEEN(0, 1), NULL, "0",
                       "Amount of reflected light."},
    [PHONG_REFRACT] = {"refract", KIND_NUMBER, OPTIONAL | OR_TEXTURE, BETWEEN(0, 1), NULL, "0",
                       "Amount of refracted light."},
    [PHONG_IOR] = {"ior", KIND_NUMBER, OPTIONAL, ABOVE(1), NULL, "1", "Index of refraction of the inside."},
    [PHONG_TWO_SIDED] = TWO_SIDED,
    SURFACE_FIELDS,
};

#define BASE                                                                                                           \
    { "material", KIND_MATERIAL, 0, ANY, NULL, NULL, "The material below." }
#define INTERP                                                                                                         \
    { "interp", KIND_WHOLE, OPTIONAL, BETWEEN(0, 1), NULL, "0", "How the noise is interpolated: 0 linear, 1 cosine." }
#define MIX                                                                                                            \
    { "mix", KIND_COLOUR, 0, ANY, NULL, NULL, "The colour mixed with kd." }

static const struct parameter marble_parameters[] = {
    [MARBLE_MATERIAL] = BASE,
    [MARBLE_F] = {"f", KIND_NUMBER, 0, ANY, NULL, NULL, "Factor of the place before the noise."},
    [MARBLE_MULTIPLIER] = {"multiplier", KIND_NUMBER, 0, ANY, NULL, NULL, "How much the noise bends the veins."},
    [MARBLE_VEIN] = {"vein_frequency", KIND_NUMBER, 0, ANY, NULL, NULL, "How close the veins are along y."},
    [MARBLE_INTERP] = INTERP,
    [MARBLE_MIX] = MIX,
};

static const struct parameter wood_parameters[] = {
    [WOOD_MATERIAL] = BASE,
    [WOOD_F] = {"f", KIND_NUMBER, 0, ANY, NULL, NULL, "Factor of the place before the noise."},
    [WOOD_DENSITY] = {"density", KIND_NUMBER, 0, ANY, NULL, NULL, "How close the grain is."},
    [WOOD_INTERP] = INTERP,
    [WOOD_MIX] = MIX,
};

#define FILTER                                                                                                         \
    {                                                                                                                  \
        "filter", KIND_CHOICE, OPTIONAL, 0, 0, LIST_BLANKS(IMAGE_FILTERS), NULL, "'mipmap'",                           \
            "How the image is looked up."                                                                              \
    }
#define WRAP                                                                                                           \
    { "wrap", KIND_CHOICE, OPTIONAL, 0, 0, LIST_BLANKS(IMAGE_WRAPS), NULL, "'repeat'", "What is beyond its edges." }
#define FLIP_U                                                                                                         \
    { "flip_u", KIND_BOOLEAN, OPTIONAL, ANY, NULL, "false", "Whether left and right are exchanged." }

static const struct parameter image_parameters[] = {
    [IMAGE_MATERIAL] = BASE,
    [IMAGE_PNG] = {"png", KIND_IMAGE, 0, ANY, NULL, NULL, "A PNG or JPEG file, or a texture."},
    [IMAGE_FILTER] = FILTER,
    [IMAGE_FLIP_U] = FLIP_U,
};

#define TILES                                                                                                          \
    { "tiles", KIND_PAIR, OPTIONAL, ANY, NULL, "1", "How many lie side by side: one number, or {across, up}." }
#define OFFSET                                                                                                         \
    { "offset", KIND_PAIR, OPTIONAL, ANY, NULL, "0", "How far it is moved, in pictures: {across, up}." }
#define LOOKUP_FIELDS(first)                                                                                           \
    [first + LOOKUP_FILTER] = FILTER, [first + LOOKUP_WRAP] = WRAP, [first + LOOKUP_FLIP_U] = FLIP_U,                  \
             [first + LOOKUP_TILES] = TILES, [first + LOOKUP_OFFSET] = OFFSET

static const struct parameter texture_parameters[] = {
    [TEXTURE_FILE] = {"file", KIND_IMAGE, 0, ANY, NULL, NULL, "A PNG or JPEG file."},
    LOOKUP_FIELDS(TEXTURE_LOOKUP),
};

#define RELIEF_AMOUNT_FIELD                                                                                            \
    {                                                                                                                  \
        "height", KIND_NUMBER, OPTIONAL, ANY, NULL, "1/50 of the picture's size; 1 for normals",                       \
            "White over black in units of the object; of normals, a factor of their slopes."                           \
    }
#define RELIEF_KIND_FIELD                                                                                              \
    {                                                                                                                  \
        "kind", KIND_CHOICE, OPTIONAL, 0, 0, LIST_BLANKS(RELIEF_KINDS), NULL, "'bump'",                                \
            "Whether it holds heights, or normals as colours: x right, y up, z out."                                   \
    }

static const struct parameter bump_parameters[] = {
    [RELIEF_FILE] = {"file", KIND_IMAGE, OR_TEXTURE, ANY, NULL, NULL, "A PNG or JPEG file, or any texture."},
    LOOKUP_FIELDS(RELIEF_LOOKUP),
    [RELIEF_AMOUNT] = RELIEF_AMOUNT_FIELD,
    [RELIEF_KIND] = RELIEF_KIND_FIELD,
};

static const struct parameter image_over_parameters[] = {
    [OVER_MATERIAL] = BASE,
    [OVER_IMAGE] = {"image", KIND_IMAGE, 0, ANY, NULL, NULL, "A PNG or JPEG file, or a texture."},
    LOOKUP_FIELDS(OVER_LOOKUP),
    [OVER_CHANNEL] = {"channel", KIND_CHOICE, OPTIONAL, 0, 0, LIST_BLANKS(IMAGE_CHANNELS), NULL, "'kd'",
                      "What the image says; where opacity is below 1 the surface has holes."},
};

static const struct parameter bump_over_parameters[] = {
    [OVER_MATERIAL] = BASE,
    [OVER_IMAGE] = {"image", KIND_IMAGE, OR_TEXTURE, ANY, NULL, NULL, "A PNG or JPEG file, or what gr.bump made."},
    LOOKUP_FIELDS(OVER_LOOKUP),
    [RELIEF_OVER_AMOUNT] = RELIEF_AMOUNT_FIELD,
    [RELIEF_OVER_KIND] = RELIEF_KIND_FIELD,
};

static const struct parameter fresnel_parameters[] = {[FRESNEL_MATERIAL] = BASE};

#define SKY_FIELDS                                                                                                     \
    [SKY_INTENSITY] = {"intensity", KIND_NUMBER, OPTIONAL, ABOVE(0), NULL, "1", "Factor of its brightness."},          \
    [SKY_ROTATION] = {"rotation",                                                                                      \
                      KIND_NUMBER,                                                                                     \
                      OPTIONAL,                                                                                        \
                      ANY,                                                                                             \
                      "degrees",                                                                                       \
                      "0",                                                                                             \
                      "How far it is turned about y, counterclockwise seen from above."}
#define SKY_FACE(text)                                                                                                 \
    { text, KIND_IMAGE, 0, ANY, NULL, NULL, "A square picture, as somebody in the middle sees it." }
#define SUN(first)                                                                                                     \
    [(first) +                                                                                                         \
        SUN_DIRECTION] =                                                                                               \
        {"sun", KIND_DIRECTION, OPTIONAL, ANY, NULL, NULL, "The direction to the sun, instead of time and place."},    \
        [(first) + SUN_HOUR] = {"hour", KIND_NUMBER, OPTIONAL, BETWEEN(0, 24), NULL, "12", "Hour of the clock."},      \
        [(first) +                                                                                                     \
            SUN_DAY] = {"day", KIND_WHOLE, OPTIONAL, BETWEEN(1, 366), NULL, "172, 21 June", "Day of the year."},       \
        [(first) + SUN_LATITUDE] = {"latitude",                                                                        \
                                    KIND_NUMBER,                                                                       \
                                    OPTIONAL,                                                                          \
                                    BETWEEN(-90, 90),                                                                  \
                                    "degrees",                                                                         \
                                    "45",                                                                              \
                                    "North is positive; -z is north and +x is east."},                                 \
        [(first) + SUN_LONGITUDE] = {"longitude", KIND_NUMBER, OPTIONAL,           BETWEEN(-180, 180),                 \
                                     "degrees",   "0",         "East is positive."},                                   \
        [(first) + SUN_ZONE] = {                                                                                       \
            "zone", KIND_NUMBER, OPTIONAL, BETWEEN(-14, 14), "hours", "0", "How far the clock is ahead of Greenwich."}

static const struct parameter sky_faces_parameters[] = {
    SKY_FIELDS,
    [FACES_FRONT] = SKY_FACE("front"),
    [FACES_RIGHT] = SKY_FACE("right"),
    [FACES_BACK] = SKY_FACE("back"),
    [FACES_LEFT] = SKY_FACE("left"),
    [FACES_TOP] = SKY_FACE("top"),
    [FACES_BOTTOM] = SKY_FACE("bottom"),
};

static const struct parameter sky_cross_parameters[] = {
    SKY_FIELDS,
    [CROSS_IMAGE] = {"image", KIND_IMAGE, 0, ANY, NULL, NULL, "A 4 x 3 cross of images all around, as a picture file."},
    [CROSS_MIRROR] = {"mirror", KIND_BOOLEAN, OPTIONAL, ANY, NULL, "false", "Whether the cross is mirrored."},
};

static const struct parameter sky_map_parameters[] = {
    SKY_FIELDS,
    [MAP_IMAGE] = {"image", KIND_IMAGE, 0, ANY, NULL, NULL,
                   "The whole sphere, longitude by latitude; -z is in its middle, +x right of it. Radiance HDR, PFM "
                   "and EXR files hold light of any brightness."},
};

static const struct parameter sky_gradient_parameters[] = {
    SKY_FIELDS,
    [GRADIENT_STOPS] = {"stops", KIND_STOPS, 0, ANY, NULL, NULL,
                        "Colours by height, {y, r, g, b}: y of the unit direction, from -1 to 1."},
};

static const struct parameter clear_sky_parameters[] = {
    SKY_FIELDS,
    SUN(CLEAR_SUN),
    [CLEAR_TURBIDITY] = {"turbidity", KIND_NUMBER, OPTIONAL, BETWEEN(1.7, 10), NULL, "2.5",
                         "How hazy the air is: 2 is very clear, 10 hazy."},
    [CLEAR_GROUND] = {"ground", KIND_COLOUR, OPTIONAL, ANY, NULL, "{0.15, 0.15, 0.15}", "What is below the horizon."},
};

static const struct parameter sun_light_parameters[] = {
    LIGHT_FIELDS(0),
    SUN(SUNLIGHT_SUN),
};

#define FOG_FIELDS                                                                                                     \
    [FOG_COLOUR] = {"colour", KIND_COLOUR, OPTIONAL, ANY, NULL, "{0.5, 0.5, 0.5}", "Its colour."},                     \
    [FOG_CLEAR_SKY] = {                                                                                                \
        "clear_sky", KIND_BOOLEAN, OPTIONAL, ANY, NULL, "false", "Whether the sky is seen without fog."}
#define FOG_DENSITY(text) [FOG_AMOUNT] = {"density", KIND_NUMBER, 0, ABOVE(0), NULL, NULL, text}

static const struct parameter fog_parameters[] = {
    FOG_FIELDS,
    FOG_DENSITY("What is d away keeps the share exp(-density d)."),
    [FOG_IS_SQUARED] = {"squared", KIND_BOOLEAN, OPTIONAL, ANY, NULL, "false",
                        "The share is exp(-(density d)^2) instead: clear near, then closing fast."},
};

static const struct parameter linear_fog_parameters[] = {
    FOG_FIELDS,
    [FOG_NEAR] = {"near", KIND_NUMBER, OPTIONAL, ABOVE(0), NULL, "0", "Where it begins."},
    [FOG_FAR] = {"far", KIND_NUMBER, LOW_OPEN, ABOVE(0), NULL, NULL, "Where nothing else is seen any more."},
};

static const struct parameter height_fog_parameters[] = {
    FOG_FIELDS,
    FOG_DENSITY("Density at the base."),
    [FOG_BASE] = {"base", KIND_NUMBER, OPTIONAL, ANY, NULL, "0", "Height y of the base."},
    [FOG_SCALE] = {"scale", KIND_NUMBER, OPTIONAL | LOW_OPEN, ABOVE(0), NULL, "1",
                   "How much higher it is thinner by the factor e."},
};

static const struct parameter fog_profile_parameters[] = {
    FOG_FIELDS,
    [FOG_PROFILE_TABLE] = {"profile", KIND_PAIRS, 0, ANY, NULL, NULL,
                           "Densities by height, {y, density}; linear between, constant beyond."},
};

static const struct parameter fog_grid_parameters[] = {
    FOG_FIELDS,
    [FOG_CORNER] = {"corner", KIND_POINT, 0, ANY, NULL, NULL, "The corner with the smallest coordinates."},
    [FOG_SIZE] = {"size", KIND_SIZE, LOW_OPEN, ABOVE(0), NULL, NULL, "Length of the edges, one number or three."},
    [FOG_CELLS] = {"cells", KIND_TRIPLE, 0, 1, 1024, NULL, NULL, NULL, "How many cells along x, y and z."},
    [FOG_DENSITIES] = {"densities", KIND_NUMBERS, 0, ABOVE(0), NULL, NULL,
                       "The density of each cell, x running fastest, then y, then z."},
};

static const struct parameter render_parameters[] = {
    [RENDER_NODE] = {"node", KIND_NODE, 0, ANY, NULL, NULL, "The root of what is drawn."},
    [RENDER_FILE] = {"file", KIND_OUTPUT, 0, ANY, NULL, NULL,
                     "The picture to write: .png, or .pfm, .hdr or .exr for linear light; missing folders are made."},
    [RENDER_SKY] = {"sky", KIND_IMAGE, OPTIONAL, ANY, NULL, NULL,
                    "A 4 x 3 cross of images all around, as a PNG or JPEG file."},
    [RENDER_WIDTH] = {"width", KIND_WHOLE, 0, 1, 1 << 20, NULL, "pixels", NULL, "Width of the picture."},
    [RENDER_HEIGHT] = {"height", KIND_WHOLE, 0, 1, 1 << 20, NULL, "pixels", NULL, "Height of the picture."},
    [RENDER_EYE] = {"eye", KIND_POINT, 0, ANY, NULL, NULL, "Where the camera stands."},
    [RENDER_VIEW] = {"view", KIND_DIRECTION, OPTIONAL, ANY, NULL, "{0, 0, -1}", "The direction it looks in."},
    [RENDER_UP] = {"up", KIND_DIRECTION, OPTIONAL, ANY, NULL, "{0, 1, 0}", "The direction that is up in the picture."},
    [RENDER_FOV] = {"fov", KIND_NUMBER, OPTIONAL | LOW_OPEN | HIGH_OPEN, 0, 180, NULL, "degrees", "50",
                    "The full vertical angle of view."},
    [RENDER_AMBIENT] = {"ambient", KIND_COLOUR, OPTIONAL, ANY, NULL, "{0, 0, 0}", "Light that is everywhere."},
    [RENDER_LIGHTS] = {"lights", KIND_LIGHTS, OPTIONAL, ANY, NULL, "{}", "A table of lights."},
    [RENDER_TARGET] = {"target", KIND_POINT, OPTIONAL, ANY, NULL, NULL, "A point to look at, instead of view."},
    [RENDER_BACKGROUND] = {"background", KIND_BACKGROUND, OPTIONAL, ANY, NULL, "'gradient'",
                           "What rays see that meet nothing: a colour, a sky, or 'gradient' for {0, 0, (1 + y)/2}."},
    [RENDER_MIRROR] = {"mirror", KIND_BOOLEAN, OPTIONAL, ANY, NULL, "false", "Whether the sky cross is mirrored."},
    [RENDER_SAMPLES] = {"samples", KIND_WHOLE, OPTIONAL, BETWEEN(1, 64), NULL, "-ss",
                        "N x N samples for a marked pixel."},
    [RENDER_FULL] = {"full", KIND_BOOLEAN, OPTIONAL, ANY, NULL, "-full", "Whether every pixel is sampled so."},
    [RENDER_AREA_SAMPLES] = {"area_samples", KIND_WHOLE, OPTIONAL, BETWEEN(1, 64), NULL, "-al-samples",
                             "N x N shadow rays for an area light."},
    [RENDER_REFLECT_LIMIT] = {"reflect_limit", KIND_WHOLE, OPTIONAL, BETWEEN(0, 1000), NULL, "-reflect-limit",
                              "How often a path may reflect."},
    [RENDER_REFRACT_LIMIT] = {"refract_limit", KIND_WHOLE, OPTIONAL, BETWEEN(0, 1000), NULL, "-refract-limit",
                              "How often a path may refract."},
    [RENDER_SIDE_TOLERANCE] = {"side_tolerance", KIND_NUMBER, OPTIONAL, ABOVE(0), NULL, "-side-tolerance",
                               "Squared distance of colours between side neighbours that marks a pixel."},
    [RENDER_CORNER_TOLERANCE] = {"corner_tolerance", KIND_NUMBER, OPTIONAL, ABOVE(0), NULL, "-corner-tolerance",
                                 "The same between corner neighbours."},
    [RENDER_USE_TIR] = {"use_tir", KIND_BOOLEAN, OPTIONAL, ANY, NULL, "-use-tir",
                        "Whether light beyond the critical angle is reflected."},
    [RENDER_SPECULAR] = {"specular", KIND_CHOICE, OPTIONAL, 0, 0, LIST_BLANKS(SPECULAR_KINDS), NULL, "--specular",
                         "The form of highlights."},
    [RENDER_SEED] = {"seed", KIND_WHOLE, OPTIONAL, BETWEEN(0, 0x1p53 - 1), NULL, "--seed", "Start of random numbers."},
    [RENDER_ACCEL] = {"accel", KIND_CHOICE, OPTIONAL, 0, 0, LIST_BLANKS(ACCEL_KINDS), NULL, "'auto'",
                      "How hits are searched; the picture is the same."},
    [RENDER_FOG] = {"fog", KIND_FOG, OPTIONAL, ANY, NULL, "none", "A fog."},
    [RENDER_CAUSTICS] = {"caustics", KIND_CAUSTICS, OPTIONAL, ANY, NULL, "--caustics",
                         "Light that glass and mirrors throw: how many photons are sent (200000), and the radius of "
                         "what each lights (by their density)."},
    [RENDER_CUTOFF] = {"cutoff", KIND_NUMBER, OPTIONAL, BETWEEN(0, 1), NULL, "--cutoff",
                       "Rays that can change a pixel by less than this are not followed."},
    [RENDER_EXPOSURE] = {"exposure", KIND_NUMBER, OPTIONAL, BETWEEN(-100, 100), "stops", "--exposure",
                         "Light is multiplied by 2^exposure on its way into a PNG file."},
    [RENDER_TONE] = {"tone", KIND_CHOICE, OPTIONAL, 0, 0, LIST_BLANKS(TONE_CURVES), NULL, "--tone",
                     "The curve that brings bright light into the range of a PNG file."},
    [RENDER_SRGB] = {"srgb", KIND_BOOLEAN, OPTIONAL, ANY, NULL, "--srgb",
                     "Whether values of a PNG file follow the sRGB transfer function."},
    [RENDER_DEEP] = {"deep", KIND_BOOLEAN, OPTIONAL, ANY, NULL, "--deep", "Whether a PNG file has 16 bits a channel."},
    [RENDER_PROJECTION] = {"projection", KIND_CHOICE, OPTIONAL, 0, 0, LIST_BLANKS(PROJECTIONS), NULL, "'perspective'",
                           "Fisheye is equidistant inside a circle; panorama is all around, longitude by latitude."},
    [RENDER_VIEW_HEIGHT] = {"view_height", KIND_NUMBER, OPTIONAL | LOW_OPEN, ABOVE(0), NULL, "2",
                            "Height of an orthographic picture in the scene."},
    [RENDER_ANGLE] = {"angle", KIND_NUMBER, OPTIONAL | LOW_OPEN, BETWEEN(0, 360), "degrees", "180",
                      "Full angle of a fisheye across the height."},
    [RENDER_SHIFT_X] = {"shift_x", KIND_NUMBER, OPTIONAL, ANY, "widths", "0",
                        "How far the window is off to the right."},
    [RENDER_SHIFT_Y] = {"shift_y", KIND_NUMBER, OPTIONAL, ANY, "heights", "0", "How far the window is off upwards."},
    [RENDER_APERTURE] = {"aperture", KIND_NUMBER, OPTIONAL, ABOVE(0), NULL, "0",
                         "Radius of the lens in the scene; 0 is a pinhole. With a lens every pixel is resampled."},
    [RENDER_FOCUS] = {"focus", KIND_NUMBER, OPTIONAL | LOW_OPEN, ABOVE(0), NULL, "target, else 1",
                      "Distance of the plane that is sharp, along the view."},
    [RENDER_FOCUS_POINT] = {"focus_point", KIND_POINT, OPTIONAL, ANY, NULL, NULL,
                            "A point of that plane, instead of focus."},
    [RENDER_BLADES] = {"blades", KIND_WHOLE, OPTIONAL, BETWEEN(3, 64), NULL, "round",
                       "Number of blades: the aperture is a polygon."},
    [RENDER_BLADE_ANGLE] = {"blade_angle", KIND_NUMBER, OPTIONAL, ANY, "degrees", "0",
                            "How far that polygon is turned."},
    [RENDER_STEREO] = {"stereo", KIND_CHOICE, OPTIONAL, 0, 0, LIST_BLANKS(STEREOS), NULL, "'none'",
                       "Two eyes: pictures side by side, left one left, or red and cyan."},
    [RENDER_EYE_DISTANCE] = {"eye_distance", KIND_NUMBER, OPTIONAL, ABOVE(0), NULL, "screen / 30",
                             "How far the eyes are apart."},
    [RENDER_SCREEN] = {"screen", KIND_NUMBER, OPTIONAL | LOW_OPEN, ABOVE(0), NULL, "focus",
                       "Distance along the view that both eyes see in the same place."},
    [RENDER_SHUTTER] = {"shutter", KIND_INTERVAL, OPTIONAL, ANY, NULL, "{0, 1}",
                        "When the shutter opens and closes, {open, close}; what moves meanwhile is blurred."},
    [RENDER_EYE_TO] = {"eye_to", KIND_POINT, OPTIONAL, ANY, NULL, "eye", "Where a moving camera stands at time 1."},
    [RENDER_VIEW_TO] = {"view_to", KIND_DIRECTION, OPTIONAL, ANY, NULL, "view", "The direction it looks in then."},
    [RENDER_TARGET_TO] = {"target_to", KIND_POINT, OPTIONAL, ANY, NULL, "target", "The point it looks at then."},
    [RENDER_UP_TO] = {"up_to", KIND_DIRECTION, OPTIONAL, ANY, NULL, "up", "The direction that is up then."},
};

static const struct parameter glyphs_parameters[] = {
    [GLYPHS_FONT] = {"font", KIND_FILE, 0, ANY, NULL, NULL, "A font file: TrueType, OpenType or Type 1."},
    [GLYPHS_TEXT] = {"text", KIND_TEXT, 0, ANY, NULL, NULL, "One line of text, in UTF-8."},
};

#define VN_FORM(first) first " verts normals faces face_normals"
#define RENDER_TAIL " width height eye view up fov ambient lights"

static const struct function node_rows[] = {
    GR("node", group_parameters, RESULT_NODE, act_node, "A node that holds others and carries a transform.", "name?"),
    GR("instances", instances_parameters, RESULT_NODE, act_instances,
       "A node that stands in many places, which cost a tenth of a node for each.", "of at"),
    GR("joint", joint_parameters, RESULT_NODE, act_joint, "A node with angles about x and y between limits.",
       "name x y"),
    GR("sphere", sphere_parameters, RESULT_NODE, act_sphere,
       "A sphere; of radius 1 at the origin if nothing else is said.", "material", "name"),
    GR("cube", cube_parameters, RESULT_NODE, act_cube, "A cube; from (0,0,0) to (1,1,1) if nothing else is said.",
       "material", "name"),
    GR("nh_sphere", sphere_parameters, RESULT_NODE, act_sphere, "A sphere at a place.", "name centre radius",
       "material centre radius"),
    GR("nh_box", cube_parameters, RESULT_NODE, act_cube, "A cube at a place.", "name corner size",
       "material corner size"),
    GR("mesh", mesh_parameters, RESULT_NODE, act_mesh, "A mesh of polygons, flat or with vertex normals.",
       "material verts faces", "name file", "name verts faces", "material file"),
    GR("fast_mesh", mesh_parameters, RESULT_NODE, act_mesh, "The same as gr.mesh: every mesh is fast.",
       "material verts faces", "name verts faces"),
    GR("vn_mesh", mesh_parameters, RESULT_NODE, act_mesh, "A mesh with vertex normals.", VN_FORM("material"),
       VN_FORM("name")),
    GR("fast_vn_mesh", mesh_parameters, RESULT_NODE, act_mesh, "The same as gr.vn_mesh.", VN_FORM("material"),
       VN_FORM("name")),
    GR("geometry", geometry_parameters, RESULT_NODE, act_geometry, "A node with the shape and look of a primitive.",
       "name primitive"),
    GR("csg_union", csg_parameters, RESULT_NODE, act_union,
       "The solid of what is in any of the operands; it has no walls inside.", "name a b", "a b"),
    GR("csg_difference", csg_parameters, RESULT_NODE, act_difference,
       "The solid of what is in the first operand and in none of the others.", "name a b", "a b"),
    GR("csg_intersection", csg_parameters, RESULT_NODE, act_intersection,
       "The solid of what is in all of the operands.", "name a b", "a b"),
    GR("csg_merge", csg_parameters, RESULT_NODE, act_union,
       "The same as gr.csg_union, which has no walls inside either; a plain node keeps them.", "name a b", "a b"),
    GR("csg_inverse", inverse_parameters, RESULT_NODE, act_inverse,
       "The solid of what is not in a: the same surface, turned inside out.", "name a", "a"),
    GR("union", csg_parameters, RESULT_NODE, act_union, "The same as gr.csg_union.", "name a b", "a b"),
    GR("difference", csg_parameters, RESULT_NODE, act_difference, "The same as gr.csg_difference.", "name a b", "a b"),
    GR("intersection", csg_parameters, RESULT_NODE, act_intersection, "The same as gr.csg_intersection.", "name a b",
       "a b"),
    GR("merge", csg_parameters, RESULT_NODE, act_union, "The same as gr.csg_merge.", "name a b", "a b"),
    GR("inverse", inverse_parameters, RESULT_NODE, act_inverse, "The same as gr.csg_inverse.", "name a", "a"),
    GR("clipped_by", clipped_parameters, RESULT_NODE, act_clipped_by,
       "The surfaces of an object where they are inside of a solid: cut open, without caps, so that one sees into it; "
       "no "
       "operand of CSG.",
       "name object by", "object by"),
    GR("bounded_by", bounded_parameters, RESULT_NODE, act_bounded_by,
       "The object, with the hint that it lies in a solid, which makes it faster where its own box is large.",
       "name object by", "object by"),
};

static const struct function material_rows[] = {
    GR("material", material_parameters, RESULT_MATERIAL, act_material, "A Phong material.", "kd ks shininess"),
    GR("rr_material", rr_parameters, RESULT_MATERIAL, act_rr_material, "A Phong material that reflects and refracts.",
       "kd ks shininess reflect refract ior"),
    GR("marble_pnd_material", marble_parameters, RESULT_MATERIAL, act_marble, "Marble over another material.",
       "material f multiplier vein_frequency interp mix"),
    GR("wood_pnd_material", wood_parameters, RESULT_MATERIAL, act_wood, "Wood over another material.",
       "material f density interp mix"),
    GR("td_cube_material", image_parameters, RESULT_MATERIAL, act_td_cube,
       "An image on each side of the unit cube, over another material.", "material png"),
    GR("td_sphere_material", image_parameters, RESULT_MATERIAL, act_td_sphere,
       "An image around the unit sphere, over another material.", "material png"),
    GR("difresnel_material", fresnel_parameters, RESULT_MATERIAL, act_fresnel,
       "A dielectric: reflects and refracts by Fresnel's equations.", "material"),
    GR("difresneld_material", fresnel_parameters, RESULT_MATERIAL, act_fresnel, "The same as gr.difresnel_material.",
       "material"),
    GR("texture", texture_parameters, RESULT_TEXTURE, act_texture,
       "An image for node:set_texture, or for inputs of gr.material.", "file"),
    GR("bump", bump_parameters, RESULT_TEXTURE, act_bump, "A bump map or normal map for node:set_bump.",
       "file height?"),
    GR("image_material", image_over_parameters, RESULT_MATERIAL, act_image_material,
       "An image by the shape's own coordinates, over another material.", "material image"),
    GR("bump_material", bump_over_parameters, RESULT_MATERIAL, act_bump_material,
       "A bump map or normal map over another material.", "material image height?"),
    GR("glyphs", glyphs_parameters, RESULT_GLYPHS, act_glyphs,
       "Outlines of a line of text in ems: letters with code, x, advance, missing, contours (cubic, as gr.prism takes "
       "them); width, ascender, descender, line.",
       "font text"),

};

static const struct function other_rows[] = {
    GR("change_node", change_node_parameters, RESULT_NOTHING, act_change_node,
       "Moves, turns or scales a node in every picture from here on, as somebody did in a window; the window writes "
       "such "
       "calls into a file for require.",
       "name serial matrix"),
    GR("change_delete", change_delete_parameters, RESULT_NOTHING, act_change_delete,
       "Leaves a node and what is under it out of every picture from here on.", "name serial"),
    GR("change_add", change_add_parameters, RESULT_NOTHING, act_change_add,
       "Adds a node to every picture from here on; gr.change_node puts it into its place.",
       "name serial shape colour? source?"),
    GR("change_material", change_material_parameters, RESULT_NOTHING, act_change_material,
       "Gives a material another colour in every picture from here on.", "serial colour"),
    GR("change_look", change_look_parameters, RESULT_NOTHING, act_change_look,
       "Changes any part of the base of a material in every picture from here on.", "serial part value"),
    GR("change_own", change_own_parameters, RESULT_NOTHING, act_change_own,
       "Gives a shape a material of its own in every picture from here on: a copy of the one it has. The first is "
       "numbered 2147483647, the next ones count down.",
       "name serial like?"),
    GR("change_light", change_light_parameters, RESULT_NOTHING, act_change_light,
       "Moves a light of every picture from here on, turns it and makes it larger or smaller, brighter or darker.",
       "number move factor? linear? colour?"),
    GR("change_delete_light", change_delete_light_parameters, RESULT_NOTHING, act_change_delete_light,
       "Takes a light away from every picture from here on.", "number"),
    GR("change_add_light", change_add_light_parameters, RESULT_NOTHING, act_change_add_light,
       "Adds a point light to every picture from here on.", "position colour"),
    GR("change_copy_light", change_copy_light_parameters, RESULT_NOTHING, act_change_copy_light,
       "Adds a copy of a light to every picture from here on.", "number move factor?"),
    GR("change_view", change_view_parameters, RESULT_NOTHING, act_change_view, "Gives a picture another camera.",
       "picture eye view up fov"),
    GR("change_exposure", change_exposure_parameters, RESULT_NOTHING, act_change_exposure,
       "Gives a picture another exposure.", "picture stops"),

    GR("sun_light", sun_light_parameters, RESULT_LIGHT, act_sun_light, "Directional light from where the sun stands.",
       "sun colour"),
    GR("sky_faces", sky_faces_parameters, RESULT_SKY, act_sky_faces,
       "A sky of six pictures on a cube: front is +z, right -x, back -z, left +x.", "front right back left top bottom"),
    GR("sky_cross", sky_cross_parameters, RESULT_SKY, act_sky_cross, "A sky from a 4 x 3 cross of images.", "image"),
    GR("sky_map", sky_map_parameters, RESULT_SKY, act_sky_map, "A sky from one picture of the whole sphere.", "image"),
    GR("sky_gradient", sky_gradient_parameters, RESULT_SKY, act_sky_gradient, "A sky of colours by height.", "stops"),
    GR("clear_sky", clear_sky_parameters, RESULT_SKY, act_clear_sky,
       "The physical clear sky of Preetham, Shirley and Smits, 1999.", "sun turbidity?"),

    GR("uniform_fog", fog_parameters, RESULT_FOG, act_fog, "Fog that is the same everywhere.", "density colour?"),
    GR("linear_fog", linear_fog_parameters, RESULT_FOG, act_linear_fog, "Fog that closes linearly with distance.",
       "near far colour?"),
    GR("height_fog", height_fog_parameters, RESULT_FOG, act_height_fog, "Fog that thins out upwards.",
       "density base scale colour?"),
    GR("fog_profile", fog_profile_parameters, RESULT_FOG, act_fog_profile, "Fog with a density for every height.",
       "profile colour?"),
    GR("fog_grid", fog_grid_parameters, RESULT_FOG, act_fog_grid, "Fog in the cells of a box, none outside.",
       "corner size cells densities colour?"),

    GR("render", render_parameters, RESULT_NOTHING, act_render, "Renders a picture into a PNG file.",
       "node file" RENDER_TAIL),
    GR("render_skybox", render_parameters, RESULT_NOTHING, act_render, "The same with a sky image all around.",
       "node file sky" RENDER_TAIL),
    GR("transform_order", order_parameters, RESULT_NOTHING, act_transform_order,
       "Says how scale, rotate and translate compose in this script.", "order"),

    NODE("add_child", child_parameters, RESULT_SELF, act_add_child, "Places a node under this one.", "node"),
    NODE("bounds", self_parameters, RESULT_BOUNDS, act_bounds,
         "The box of this node and what is under it, where its transforms have put it: smallest and largest x, y, z.",
         ""),
    NODE("faces", self_parameters, RESULT_FACES, act_faces,
         "The vertices and faces of a mesh, in its own coordinates and as gr.mesh takes them.", ""),
    NODE("set_material", set_material_parameters, RESULT_SELF, act_set_material, "Gives a shape its material.",
         "material"),
    NODE("set_texture", set_texture_parameters, RESULT_SELF, act_set_texture, "Puts an image in the place of kd.",
         "texture"),
    NODE("set_bump", set_bump_parameters, RESULT_SELF, act_set_bump, "Puts a bump map on a shape.", "bump"),
    NODE("scale", scale_parameters, RESULT_SELF, act_scale, "Scales this node.", "x y z", "vector"),
    NODE("rotate", rotate_parameters, RESULT_SELF, act_rotate, "Turns this node about an axis.", "axis angle"),
    NODE("velocity", velocity_parameters, RESULT_SELF, act_velocity,
         "Lets this node move while the shutter is open; where its transforms put it is its place at time 0.", "x y z",
         "vector"),
    NODE("moves_to", moves_to_parameters, RESULT_SELF, act_moves_to,
         "Lets this node move from where its transforms put it at time 0 to where another's do at time 1, turning the "
         "short way.",
         "node"),
    NODE("rotate_axis", rotate_axis_parameters, RESULT_SELF, act_rotate_axis, "Turns this node about any direction.",
         "axis angle"),
    NODE("rotate_quat", rotate_quat_parameters, RESULT_SELF, act_rotate_quat, "Turns this node by a quaternion.",
         "w x y z", "quaternion"),
    NODE("translate", translate_parameters, RESULT_SELF, act_translate, "Moves this node.", "x y z", "vector"),
    NODE("render", render_parameters, RESULT_NOTHING, act_render, "The same as gr.render with this node.",
         "file" RENDER_TAIL),
};

static const struct function_rows node_functions = {node_rows, COUNT(node_rows)};
static const struct function_rows material_functions = {material_rows, COUNT(material_rows)};
static const struct function_rows other_functions = {other_rows, COUNT(other_rows)};
/* In the order of the manual. */
static const struct function_rows *const parts[] = {&node_functions,    &shape_functions,    &swept_functions,
                                                    &texture_functions, &material_functions, &light_functions,
                                                    &other_functions};

int function_count(void) {
    int count = 0;
    for (int part = 0; part < COUNT(parts); part++)
        count += parts[part]->count;
    return count;
}

const struct function *function_at(int index) {
    int part = 0;
    for (; index >= parts[part]->count; part++)
        index -= parts[part]->count;
    return &parts[part]->rows[index];
}

int function_index(const struct function *function) {
    int index = 0;
    while (function_at(index) != function)
        index++;
    return index;
}

const struct function *function_find(enum owner owner, const char *name) {
    for (int i = 0; i < function_count(); i++) {
        const struct function *function = function_at(i);
        if (function->owner == owner && strcmp(function->name, name) == 0)
            return function;
    }
    return NULL;
}

bool form_next(const struct function *function, const char **form, int *index, bool *optional) {
    const char *word = *form;
    while (*word == ' ')
        word++;
    if (*word == '\0')
        return false;
    size_t length = strcspn(word, " ?");
    *optional = word[length] == '?';
    *form = word + length + (*optional ? 1 : 0);
    for (*index = 0;; (*index)++) {
        assert(*index < function->parameter_count); /* every name in a form is that of a parameter: a test looks */
        const char *name = function->parameters[*index].name;
        if (strncmp(name, word, length) == 0 && name[length] == '\0')
            return true;
    }
}

const char *kind_words(enum kind kind) {
    switch (kind) {
    case KIND_NUMBER:
        return "a number";
    case KIND_WHOLE:
        return "a whole number";
    case KIND_BOOLEAN:
        return "true or false";
    case KIND_TEXT:
        return "a string";
    case KIND_FILE:
        return "the name of a file";
    case KIND_OUTPUT:
        return "the name of a file";
    case KIND_CHOICE:
        return "a word";
    case KIND_AXIS:
        return "'x', 'y' or 'z'";
    case KIND_POINT:
        return "a point {x, y, z}";
    case KIND_DIRECTION:
        return "a direction {x, y, z}";
    case KIND_COLOUR:
        return "a colour {r, g, b}";
    case KIND_TRIPLE:
        return "a table of 3 numbers";
    case KIND_INTERVAL:
        return "a table of two rising numbers";
    case KIND_SIZE:
        return "a number or a table of 3 numbers";
    case KIND_QUATERNION:
        return "a table of 4 numbers {w, x, y, z}";
    case KIND_PAIR:
        return "a number or a table of 2 numbers";
    case KIND_NODE:
        return "a node";
    case KIND_MATERIAL:
        return "a material";
    case KIND_MATERIALS:
        return "a table of materials";
    case KIND_IMAGE:
        return "the name of a picture file or a texture";
    case KIND_BACKGROUND:
        return "a colour {r, g, b}, a sky or 'gradient'";
    case KIND_FOG:
        return "a fog";
    case KIND_CAUSTICS:
        return "a number of photons or {photons = ..., radius = ...}";
    case KIND_STOPS:
        return "a table of stops {height, r, g, b}";
    case KIND_NODES:
        return "a table of nodes";
    case KIND_LIGHTS:
        return "a table of lights";
    case KIND_POINTS:
        return "a table of points {x, y, z}";
    case KIND_PAIRS:
        return "a table of pairs {u, v}";
    case KIND_FACES:
        return "a table of tuples of indices";
    case KIND_NUMBERS:
        return "a number or a table of numbers";
    case KIND_ROWS:
        return "a table of tables of numbers";
    case KIND_CURVES:
        return "a table of tables of pairs {x, z}";
    case KIND_COUNT:
        break;
    }
    UNREACHABLE("a parameter of no kind");
}
