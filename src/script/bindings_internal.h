/* The C functions behind the gr functions; they cannot raise Lua errors. The enums number the parameters in table.c;
 * gr_shapes.c, gr_swept.c and gr_lights.c also contain the parameters and rows of their functions. */
#ifndef GRAY_SCRIPT_BINDINGS_INTERNAL_H
#define GRAY_SCRIPT_BINDINGS_INTERNAL_H

#include "call/context.h"

typedef bool binding(struct script_context *context, const struct script_value *args, struct script_result *result,
                     struct error *error);

/* gr_nodes.c */
enum { GROUP_NAME, GROUP_CHILDREN, GROUP_COUNT };
enum { INSTANCES_NAME, INSTANCES_OF, INSTANCES_AT, INSTANCES_TURN, INSTANCES_AXIS, INSTANCES_SIZE, INSTANCES_COUNT };
enum { JOINT_NAME, JOINT_X, JOINT_Y, JOINT_CHILDREN, JOINT_COUNT };
enum { SPHERE_NAME, SPHERE_MATERIAL, SPHERE_CENTRE, SPHERE_RADIUS, SPHERE_COUNT };
enum { CUBE_NAME, CUBE_MATERIAL, CUBE_CORNER, CUBE_SIZE, CUBE_COUNT };
enum { GEOMETRY_NAME, GEOMETRY_PRIMITIVE, GEOMETRY_MATERIAL, GEOMETRY_COUNT };
enum { CSG_NAME, CSG_A, CSG_B, CSG_OPERANDS, CSG_COUNT };
enum { INVERSE_NAME, INVERSE_A, INVERSE_COUNT };
enum { CLIPPED_NAME, CLIPPED_OBJECT, CLIPPED_BY, CLIPPED_COUNT };
binding gr_node, gr_instances, gr_joint, gr_sphere, gr_cube, gr_geometry, gr_union, gr_difference, gr_intersection;
binding gr_inverse, gr_clipped_by, gr_bounded_by, gr_transform_order;

/* gr_changes.c */
enum { CHANGENODE_NAME, CHANGENODE_SERIAL, CHANGENODE_MATRIX, CHANGENODE_COUNT };
enum { CHANGEGONE_NAME, CHANGEGONE_SERIAL, CHANGEGONE_COUNT };
enum { CHANGEADD_NAME, CHANGEADD_SERIAL, CHANGEADD_SHAPE, CHANGEADD_COLOUR, CHANGEADD_SOURCE, CHANGEADD_COUNT };
enum { CHANGEMATERIAL_SERIAL, CHANGEMATERIAL_COLOUR, CHANGEMATERIAL_COUNT };
enum { CHANGELOOK_SERIAL, CHANGELOOK_PART, CHANGELOOK_VALUE, CHANGELOOK_COUNT };
enum { CHANGEOWN_NAME, CHANGEOWN_SERIAL, CHANGEOWN_LIKE, CHANGEOWN_COUNT };
enum {
    CHANGELIGHT_NUMBER,
    CHANGELIGHT_MOVE,
    CHANGELIGHT_FACTOR,
    CHANGELIGHT_TURN,
    CHANGELIGHT_COLOUR,
    CHANGELIGHT_COUNT
};
enum { CHANGEDARK_NUMBER, CHANGEDARK_COUNT };
enum { CHANGECOPYLIGHT_NUMBER, CHANGECOPYLIGHT_MOVE, CHANGECOPYLIGHT_FACTOR, CHANGECOPYLIGHT_COUNT };
enum { CHANGENEWLIGHT_POSITION, CHANGENEWLIGHT_COLOUR, CHANGENEWLIGHT_COUNT };
enum { CHANGEVIEW_PICTURE, CHANGEVIEW_EYE, CHANGEVIEW_VIEW, CHANGEVIEW_UP, CHANGEVIEW_FOV, CHANGEVIEW_COUNT };
enum { CHANGEEXPOSURE_PICTURE, CHANGEEXPOSURE_STOPS, CHANGEEXPOSURE_COUNT };
binding gr_change_node, gr_change_delete, gr_change_add, gr_change_material, gr_change_look, gr_change_own,
    gr_change_copy_light, gr_change_light, gr_change_delete_light, gr_change_add_light, gr_change_view,
    gr_change_exposure;

/* gr_methods.c: args[0] is the node itself */
enum { CHILD_NODE = 1, CHILD_COUNT };
enum { SET_MATERIAL = 1, SET_MATERIAL_COUNT };
enum { SET_TEXTURE = 1, SET_TEXTURE_COUNT };
enum { SET_BUMP = 1, SET_BUMP_COUNT };
enum { STEP_X = 1, STEP_Y, STEP_Z, STEP_VECTOR, STEP_COUNT };
enum { ROTATE_AXIS = 1, ROTATE_ANGLE, ROTATE_COUNT };
enum { QUAT_W = 1, QUAT_X, QUAT_Y, QUAT_Z, QUAT_TABLE, QUAT_COUNT };
enum { POSE_TRANSLATE = 1, POSE_ROTATE, POSE_SCALE, POSE_COUNT };
enum { MOVES_TO_NODE = 1, MOVES_TO_COUNT };
enum { SPIN_AXIS = 1, SPIN_DEGREES, SPIN_DIRECTION, SPIN_COUNT };
binding gr_add_child, gr_set_material, gr_set_texture, gr_set_bump, gr_scale, gr_rotate, gr_translate;
binding gr_rotate_axis, gr_rotate_quat, gr_velocity, gr_moves_to, gr_spin, gr_reset, gr_pose;

/* gr_mesh.c */
enum {
    MESH_NAME,
    MESH_MATERIAL,
    MESH_FILE,
    MESH_VERTS,
    MESH_NORMALS,
    MESH_FACES,
    MESH_FACE_NORMALS,
    MESH_UVS,
    MESH_FACE_UVS,
    MESH_SMOOTH,
    MESH_WELD,
    MESH_FLIP,
    MESH_CULL,
    MESH_MATERIALS,
    MESH_FACE_MATERIALS,
    MESH_COUNT
};
struct height_field_input;
/* gr_displace.c: the heights of a grid, or 0 if it has none, plus those of a function; in the arena of the call. NULL
 * with an error. */
const double *gr_function_heights(struct script_context *context, const struct height_field_input *grid,
                                  const struct expr_program *program, struct error *error);

binding gr_mesh, gr_bounds, gr_faces; /* the last two: args[SELF] is the node */

/* gr_mesh.c */
enum { GLYPHS_FONT, GLYPHS_TEXT, GLYPHS_COUNT };
binding gr_glyphs;

/* gr_materials.c */
enum {
    PHONG_KD,
    PHONG_KS,
    PHONG_SHININESS,
    PHONG_REFLECT,
    PHONG_REFRACT,
    PHONG_IOR,
    PHONG_TWO_SIDED,
    PHONG_HIGHLIGHT,
    PHONG_LIT,
    PHONG_EMISSION,
    PHONG_ROUGHNESS,
    PHONG_GLOSSY_SAMPLES,
    PHONG_ABSORPTION,
    PHONG_OPACITY,
    PHONG_METALNESS,
    PHONG_BUMP,
    PHONG_COUNT
};
enum { MARBLE_MATERIAL, MARBLE_F, MARBLE_MULTIPLIER, MARBLE_VEIN, MARBLE_INTERP, MARBLE_MIX, MARBLE_COUNT };
enum { WOOD_MATERIAL, WOOD_F, WOOD_DENSITY, WOOD_INTERP, WOOD_MIX, WOOD_COUNT };
enum { IMAGE_MATERIAL, IMAGE_PNG, IMAGE_FILTER, IMAGE_FLIP_U, IMAGE_MAPPING, IMAGE_COUNT };
/* How an image is looked up: these fields always follow one another. */
enum {
    LOOKUP_FILTER,
    LOOKUP_WRAP,
    LOOKUP_FLIP_U,
    LOOKUP_TILES,
    LOOKUP_OFFSET,
    LOOKUP_ENCODING,
    LOOKUP_MAPPING,
    LOOKUP_COUNT
};
enum { TEXTURE_FILE, TEXTURE_LOOKUP };
enum { BUMP_FILE, BUMP_LOOKUP, BUMP_AMOUNT = BUMP_LOOKUP + LOOKUP_COUNT, BUMP_KIND };
enum { OVER_MATERIAL, OVER_IMAGE, OVER_LOOKUP, OVER_CHANNEL = OVER_LOOKUP + LOOKUP_COUNT };
/* The choices of these parameters. */
#define HIGHLIGHTS(X) X(HIGHLIGHT_PHONG, "phong") X(HIGHLIGHT_BLINN, "blinn")
#define SPHERE_MAPPINGS(X) X(SPHERE_MAPPING_CLASSIC, "classic") X(SPHERE_MAPPING_OUTSIDE, "outside")
enum { SPHERE_MAPPINGS(LIST_MEMBER) };
#define IMAGE_CHANNELS(X) X(INPUT_KD, "kd") X(INPUT_KS, "ks") X(INPUT_EMISSION, "emission") X(INPUT_OPACITY, "opacity")
#define BUMP_KINDS(X) X(MATERIAL_BUMP, "bump") X(MATERIAL_NORMAL, "normal")
enum { BUMP_OVER_AMOUNT = OVER_LOOKUP + LOOKUP_COUNT, BUMP_OVER_KIND };
enum { FRESNEL_MATERIAL, FRESNEL_COUNT };
binding gr_material, gr_rr_material, gr_marble, gr_wood, gr_td_cube, gr_td_sphere, gr_fresnel, gr_texture;
binding gr_bump, gr_image_material, gr_bump_material;
/* The image of an argument, from the store or from its file; NULL with an error. */
struct image *gr_find_image(struct script_context *context, const struct script_value *value, struct error *error);

/* The image for node:set_texture: with the lookup of its texture, else mip-mapped and repeated; NULL with an error. */
const struct texture_image *gr_image(struct script_context *context, const struct script_value *value,
                                     struct error *error);
/* The bump map for node:set_bump: a result of gr.bump, or any other image with the default height. */
const struct bump *read_bump_values(struct script_context *context, const struct script_value *value,
                                    struct error *error);

/* gr_environment.c; the fields of the sun follow one another from SUN_DIRECTION on */
enum { SUN_DIRECTION, SUN_HOUR, SUN_DAY, SUN_LATITUDE, SUN_LONGITUDE, SUN_ZONE, SUN_YEAR, SUN_FIELDS };
enum { SKY_INTENSITY, SKY_ROTATION, SKY_OWN };
enum { FACES_FRONT = SKY_OWN, FACES_RIGHT, FACES_BACK, FACES_LEFT, FACES_TOP, FACES_BOTTOM };
enum { CROSS_IMAGE = SKY_OWN, CROSS_MIRROR };
enum { MAP_IMAGE = SKY_OWN };
enum { GRADIENT_STOPS = SKY_OWN };
enum { SKYFUNCTION_F = SKY_OWN };
enum { CLEAR_SUN = SKY_OWN, CLEAR_TURBIDITY = CLEAR_SUN + SUN_FIELDS, CLEAR_GROUND };
binding gr_sky_faces, gr_sky_cross, gr_sky_map, gr_sky_gradient, gr_sky_function, gr_clear_sky, gr_sun_light;

/* gr_environment.c */
enum { FOG_COLOUR, FOG_CLEAR_SKY, FOG_OWN };
enum { FOG_AMOUNT = FOG_OWN, FOG_IS_SQUARED, FOG_COUNT };
enum { FOG_NEAR = FOG_OWN, FOG_FAR };
enum { FOG_BASE = FOG_AMOUNT + 1, FOG_SCALE };
enum { FOG_PROFILE_TABLE = FOG_OWN };
enum { FOG_CORNER = FOG_OWN, FOG_SIZE, FOG_CELLS, FOG_DENSITIES };
enum { FOG_FIELD_DENSITY = FOG_SIZE + 1 }; /* after FOG_CORNER and FOG_SIZE */
binding gr_fog, gr_linear_fog, gr_height_fog, gr_fog_profile, gr_fog_grid, gr_fog_field;

/* Every light has these first; fields of fading and of lamps only where the kind has them. */
enum {
    LIGHT_COLOUR,
    LIGHT_INCLUDE,
    LIGHT_EXCLUDE,
    LIGHT_FALLOFF,
    LIGHT_RANGE,
    LIGHT_INTENSITY,
    LIGHT_EMISSION,
    LIGHT_SAMPLES,
    LIGHT_VISIBLE,
    LIGHT_OWN /* the first field of the kind itself */
};
/* gr_lights.c; the other lights are there, with their parameters and rows. */
enum { DISTANT_DIRECTION = LIGHT_EXCLUDE + 1, DISTANT_COUNT };
enum { SUNLIGHT_SUN = LIGHT_EXCLUDE + 1 };
binding gr_directional_light;

/* gr_render.c */
enum {
    RENDER_NODE,
    RENDER_FILE,
    RENDER_SKY,
    RENDER_WIDTH,
    RENDER_HEIGHT,
    RENDER_EYE,
    RENDER_VIEW,
    RENDER_UP,
    RENDER_FOV,
    RENDER_AMBIENT,
    RENDER_LIGHTS,
    RENDER_TARGET,
    RENDER_BACKGROUND,
    RENDER_MIRROR,
    RENDER_SAMPLES,
    RENDER_FULL,
    RENDER_AREA_SAMPLES,
    RENDER_REFLECT_LIMIT,
    RENDER_REFRACT_LIMIT,
    RENDER_SIDE_TOLERANCE,
    RENDER_CORNER_TOLERANCE,
    RENDER_USE_TIR,
    RENDER_SPECULAR,
    RENDER_SEED,
    RENDER_ACCEL,
    RENDER_FOG,
    RENDER_CAUSTICS,
    RENDER_CUTOFF,
    RENDER_INTEGRATOR,
    RENDER_SPP,
    RENDER_MAX_DEPTH,
    RENDER_NOISE,
    RENDER_CLAMP,
    RENDER_FILTER,
    RENDER_DENOISE,
    RENDER_EXPOSURE,
    RENDER_TONE,
    RENDER_SRGB,
    RENDER_COLOUR,
    RENDER_DEEP,
    RENDER_STYLE,
    RENDER_LINE_WIDTH,
    RENDER_TOON_STEPS,
    RENDER_BLOOM,
    RENDER_VIGNETTE,
    RENDER_GRAY,
    RENDER_EDGES,
    RENDER_FXAA,
    RENDER_DITHER,
    RENDER_PROJECTION,
    RENDER_VIEW_HEIGHT,
    RENDER_ANGLE,
    RENDER_SHIFT_X,
    RENDER_SHIFT_Y,
    RENDER_APERTURE,
    RENDER_FOCUS,
    RENDER_FOCUS_POINT,
    RENDER_BLADES,
    RENDER_BLADE_ANGLE,
    RENDER_STEREO,
    RENDER_EYE_DISTANCE,
    RENDER_SCREEN,
    RENDER_SHUTTER,
    RENDER_EYE_TO,
    RENDER_VIEW_TO,
    RENDER_TARGET_TO,
    RENDER_UP_TO,
    RENDER_COUNT
};
binding gr_render;

#endif
