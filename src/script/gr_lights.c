/* Lights of the language: the parameters, the function and the table row of each. */
#include "script/gr_lights_internal.h"

#include "call/context.h"
#include "math/elementary.h"
#include "script/table_internal.h"

enum { POINT_POSITION = LIGHT_INTENSITY + 1 };
enum { SPOT_POSITION = LIGHT_INTENSITY + 1, SPOT_DIRECTION, SPOT_TARGET, SPOT_INNER, SPOT_OUTER };
enum { AREA_CORNER = LIGHT_OWN, AREA_V1, AREA_V2, AREA_ONE_SIDED };
enum { BALL_POSITION = LIGHT_OWN, BALL_RADIUS };
enum { PANEL_POSITION = LIGHT_OWN, PANEL_NORMAL, PANEL_RADIUS, PANEL_ONE_SIDED };
enum { MESHLIGHT_EMISSION = LIGHT_EXCLUDE + 1, MESHLIGHT_SAMPLES, MESHLIGHT_MESH, MESHLIGHT_COUNT };
enum { SKYLIGHT_SKY = LIGHT_EXCLUDE + 1, SKYLIGHT_SAMPLES, SKYLIGHT_COUNT };

#define ATTENUATION_FIELDS                                                                                             \
    [LIGHT_FALLOFF] = ROW("falloff", KIND_TRIPLE, OPTIONAL, ANY, NULL, "{1, 0, 0}",                                    \
                          "Coefficients c0, c1, c2: the falloff is 1 / (c0 + c1 d + c2 d^2)."),                        \
    [LIGHT_RANGE] = ROW("range", KIND_NUMBER, OPTIONAL | LOW_OPEN, ABOVE(0), NULL, NULL,                               \
                        "Range, instead of falloff: the light is multiplied by 1 - d / range, and is 0 beyond."),      \
    [LIGHT_INTENSITY] = ROW("intensity", KIND_NUMBER, OPTIONAL, ABOVE(0), NULL, NULL,                                  \
                            "Inverse square falloff, instead of falloff: the light is multiplied by intensity / d^2.")
#define AREA_LIGHT_FIELDS                                                                                              \
    [LIGHT_EMISSION] = ROW(                                                                                            \
        "emission", KIND_COLOUR, OPTIONAL, ANY, NULL, NULL,                                                            \
        "Radiance of its surface, multiplied by colour; the light then depends on its true shape, without falloff."),  \
    [LIGHT_SAMPLES] = ROW("samples", KIND_WHOLE, OPTIONAL, IN_RANGE(1, 64), NULL, "area_samples",                      \
                          "N x N shadow rays for this light."),                                                        \
    [LIGHT_VISIBLE] =                                                                                                  \
        ROW("visible", KIND_BOOLEAN, OPTIONAL, ANY, NULL, "false", "Whether the light itself is visible.")
#define ONE_SIDED(text)                                                                                                \
    ROW("one_sided", KIND_BOOLEAN, OPTIONAL, ANY, NULL, "false",                                                       \
        "Whether it emits, and is visible, only on the side of " text ".")

static const struct script_parameter light_parameters[] = {
    LIGHT_FIELDS(OR_PROFILE),
    ATTENUATION_FIELDS,
    [POINT_POSITION] = {"position", KIND_POINT, 0, ANY, NULL, NULL, "Position."},
};

#define SAMPLES_FIELD                                                                                                  \
    ROW("samples", KIND_WHOLE, OPTIONAL, IN_RANGE(1, 64), NULL, "area_samples", "N x N shadow rays for this light.")

static const struct script_parameter mesh_light_parameters[] = {
    LIGHT_FIELDS(OPTIONAL),
    [MESHLIGHT_EMISSION] = {"emission", KIND_COLOUR, OPTIONAL, ANY, NULL, "its materials'",
                            "Radiance of its surface, multiplied by colour."},
    [MESHLIGHT_SAMPLES] = SAMPLES_FIELD,
    [MESHLIGHT_MESH] = {"mesh", KIND_NODE, 0, ANY, NULL, NULL,
                        "A mesh, or a node with meshes below it. It emits at each of its positions in the scene; if it "
                        "is not in the scene, it emits invisibly at its own transforms."},
};

static const struct script_parameter sky_light_parameters[] = {
    LIGHT_FIELDS(OPTIONAL),
    [SKYLIGHT_SKY] = {"sky", KIND_BACKGROUND, 0, ANY, NULL, NULL,
                      "A sky, a colour, a function of the unit direction, or 'gradient'."},
    [SKYLIGHT_SAMPLES] = SAMPLES_FIELD,
};

static const struct script_parameter directional_parameters[] = {
    LIGHT_FIELDS(0),
    [DISTANT_DIRECTION] = {"direction", KIND_DIRECTION, 0, ANY, NULL, NULL, "Direction in which the light travels."},
};

static const struct script_parameter spot_parameters[] = {
    LIGHT_FIELDS(OR_PROFILE),
    ATTENUATION_FIELDS,
    [SPOT_POSITION] = {"position", KIND_POINT, 0, ANY, NULL, NULL, "Position."},
    [SPOT_DIRECTION] = {"direction", KIND_DIRECTION, OPTIONAL, ANY, NULL, "{0, -1, 0}", "The axis of its cone."},
    [SPOT_TARGET] = {"target", KIND_POINT, OPTIONAL, ANY, NULL, NULL, "A point on the axis, instead of direction."},
    [SPOT_INNER] = {"inner", KIND_NUMBER, OPTIONAL, IN_RANGE(0, 180), "degrees", "three quarters of outer",
                    "Angle from the axis where the light begins to fall off."},
    [SPOT_OUTER] = {"outer", KIND_NUMBER, OPTIONAL | LOW_OPEN, IN_RANGE(0, 180), "degrees",
                    "30, or inner if that is more", "Angle from the axis where the light ends."},
};

static const struct script_parameter area_parameters[] = {
    LIGHT_FIELDS(OPTIONAL | OR_PROFILE),
    ATTENUATION_FIELDS,
    AREA_LIGHT_FIELDS,
    [AREA_CORNER] = {"corner", KIND_POINT, 0, ANY, NULL, NULL, "One corner of the parallelogram."},
    [AREA_V1] = {"v1", KIND_DIRECTION, 0, ANY, NULL, NULL, "Edge from that corner."},
    [AREA_V2] = {"v2", KIND_DIRECTION, 0, ANY, NULL, NULL, "The other edge from that corner."},
    [AREA_ONE_SIDED] = ONE_SIDED("v1 x v2"),
};

static const struct script_parameter ball_light_parameters[] = {
    LIGHT_FIELDS(OPTIONAL | OR_PROFILE),
    ATTENUATION_FIELDS,
    AREA_LIGHT_FIELDS,
    [BALL_POSITION] = {"position", KIND_POINT, 0, ANY, NULL, NULL, "Its centre."},
    [BALL_RADIUS] = {"radius", KIND_NUMBER, LOW_OPEN, ABOVE(0), NULL, NULL, "Its radius."},
};

static const struct script_parameter disc_light_parameters[] = {
    LIGHT_FIELDS(OPTIONAL | OR_PROFILE),
    ATTENUATION_FIELDS,
    AREA_LIGHT_FIELDS,
    [PANEL_POSITION] = {"position", KIND_POINT, 0, ANY, NULL, NULL, "Its centre."},
    [PANEL_NORMAL] = {"normal", KIND_DIRECTION, 0, ANY, NULL, NULL, "The direction it faces."},
    [PANEL_RADIUS] = {"radius", KIND_NUMBER, LOW_OPEN, ABOVE(0), NULL, NULL, "Its radius."},
    [PANEL_ONE_SIDED] = ONE_SIDED("its normal"),
};

/* The nodes of a list, copied to the arena of the scene. */
static bool keep_nodes(struct script_context *context, const struct script_value *value,
                       const struct node *const **nodes, uint32_t *count) {
    *nodes = NULL;
    *count = value->count;
    if (!value->given)
        return true;
    const struct node **kept = arena_alloc_array(&context->scene.arena, value->count + 1, sizeof *kept);
    for (uint32_t i = 0; kept && i < value->count; i++)
        kept[i] = value->nodes[i];
    *nodes = kept;
    return kept != NULL;
}

/* Lights that fade with distance and those that emit may have large numbers, and the sun may have some. */
static void warn_of_bytes(struct script_context *context, const struct light *light, struct colour colour) {
    bool fades = light->attenuation != ATTENUATION_COEFFICIENTS || light->falloff[1] != 0 || light->falloff[2] != 0;
    if (!fades && !light->emissive && colour_max_abs(colour) >= 100)
        context_warn_of_bytes(context, "colour", colour);
}

/* Sets what every light has, and copies the light to the arena of the scene. */
static bool give_light(struct script_context *context, const struct light *light, const struct script_value *args,
                       struct script_result *result, struct error *error) {
    struct scene_light *kept = arena_alloc(&context->scene.arena, sizeof *kept);
    if (!kept || !keep_nodes(context, &args[LIGHT_INCLUDE], &kept->include, &kept->include_count) ||
        !keep_nodes(context, &args[LIGHT_EXCLUDE], &kept->exclude, &kept->exclude_count))
        return error_no_memory(error, "a light");
    kept->light = *light;
    kept->light.colour = args[LIGHT_COLOUR].colour;
    warn_of_bytes(context, light, kept->light.colour);
    kept->light.has_display = args[LIGHT_COLOUR].display;
    kept->light.display = kept->light.colour;
    result->pointer = kept;
    return !args[LIGHT_COLOUR].program || light_set_profile(&kept->light, args[LIGHT_COLOUR].program, error);
}

static bool set_attenuation(struct light *light, const struct script_value *args, struct error *error) {
    struct vec3 c = args[LIGHT_FALLOFF].given ? args[LIGHT_FALLOFF].vector : (struct vec3){1, 0, 0};
    if (args[LIGHT_FALLOFF].given + args[LIGHT_RANGE].given + args[LIGHT_INTENSITY].given > 1)
        return error_set(error, ERROR_SCENE, "falloff, range and intensity exclude each other");
    light->falloff[0] = c.x;
    light->falloff[1] = c.y;
    light->falloff[2] = c.z;
    light->range = args[LIGHT_RANGE].number;
    light->intensity = args[LIGHT_INTENSITY].number;
    light->attenuation = args[LIGHT_RANGE].given       ? ATTENUATION_RANGE
                         : args[LIGHT_INTENSITY].given ? ATTENUATION_INVERSE_SQUARE
                                                       : ATTENUATION_COEFFICIENTS;
    return true;
}

/* A light with an extent: falloff as from its centre, or a lamp whose surface emits. */
static bool make_area_light(struct script_context *context, struct light *light, const struct script_value *args,
                            struct script_result *result, struct error *error) {
    struct script_value area_light[LIGHT_OWN];
    for (int i = 0; i < LIGHT_OWN; i++)
        area_light[i] = args[i];
    light->emissive = args[LIGHT_EMISSION].given;
    light->samples = (int)args[LIGHT_SAMPLES].number;
    light->visible = args[LIGHT_VISIBLE].boolean;
    if (!args[LIGHT_COLOUR].given && !light->emissive)
        return error_set(error, ERROR_SCENE, "colour is missing");
    if (light->emissive && (args[LIGHT_FALLOFF].given || args[LIGHT_RANGE].given || args[LIGHT_INTENSITY].given))
        return error_set(error, ERROR_SCENE, "a light with emission has no falloff, range or intensity");
    if (light->emissive && !args[LIGHT_COLOUR].given)
        area_light[LIGHT_COLOUR].colour = colour_all(1);
    if (!set_attenuation(light, args, error) || !give_light(context, light, area_light, result, error))
        return false;
    struct scene_light *kept = result->pointer;
    if (light->emissive)
        kept->light.colour = colour_mul(kept->light.colour, args[LIGHT_EMISSION].colour);
    return true;
}

static bool set_direction(struct light *light, struct vec3 direction, const char *name, struct error *error) {
    if (!(vec3_length(direction) > 0))
        return error_set(error, ERROR_SCENE, "%s must not be zero", name);
    light->direction = vec3_normalize(direction);
    return true;
}

static bool gr_light(struct script_context *context, const struct script_value *args, struct script_result *result,
                     struct error *error) {
    struct light light = {.kind = LIGHT_POINT, .position = args[POINT_POSITION].vector};
    return set_attenuation(&light, args, error) && give_light(context, &light, args, result, error);
}

bool gr_directional_light(struct script_context *context, const struct script_value *args, struct script_result *result,
                          struct error *error) {
    struct light light = {.kind = LIGHT_DIRECTIONAL};
    return set_direction(&light, args[DISTANT_DIRECTION].vector, "direction", error) &&
           give_light(context, &light, args, result, error);
}

static bool gr_spot_light(struct script_context *context, const struct script_value *args, struct script_result *result,
                          struct error *error) {
    struct light light = {.kind = LIGHT_SPOT, .position = args[SPOT_POSITION].vector};
    const struct script_value *inner = &args[SPOT_INNER], *outer = &args[SPOT_OUTER];
    if (args[SPOT_DIRECTION].given && args[SPOT_TARGET].given)
        return error_set(error, ERROR_SCENE, "direction and target exclude each other");
    double outer_angle = outer->given ? outer->number : inner->given && inner->number > 30 ? inner->number : 30;
    double inner_angle = inner->given ? inner->number : 0.75 * outer_angle;
    if (inner_angle > outer_angle)
        return error_set(error, ERROR_SCENE, "inner must be at most outer, the angle where the light ends");
    const double degree = PI / 180;
    light.cos_inner = el_cos(inner_angle * degree);
    light.cos_outer = el_cos(outer_angle * degree);
    struct vec3 axis = args[SPOT_TARGET].given      ? vec3_sub(args[SPOT_TARGET].vector, light.position)
                       : args[SPOT_DIRECTION].given ? args[SPOT_DIRECTION].vector
                                                    : (struct vec3){0, -1, 0};
    return set_direction(&light, axis, args[SPOT_TARGET].given ? "the direction to target" : "direction", error) &&
           set_attenuation(&light, args, error) && give_light(context, &light, args, result, error);
}

static bool gr_area_light(struct script_context *context, const struct script_value *args, struct script_result *result,
                          struct error *error) {
    struct light light = {.kind = LIGHT_PARALLELOGRAM,
                          .corner = args[AREA_CORNER].vector,
                          .edge1 = args[AREA_V1].vector,
                          .edge2 = args[AREA_V2].vector,
                          .one_sided = args[AREA_ONE_SIDED].boolean};
    light.position = vec3_add_scaled(vec3_add_scaled(light.corner, light.edge1, 0.5), light.edge2, 0.5);
    double area = vec3_length(vec3_cross(light.edge1, light.edge2));
    if (!(area > 0x1p-40 * vec3_length(light.edge1) * vec3_length(light.edge2)))
        context_warn_once(context, WARNED_OTHER, "v1 and v2 are parallel or zero: the light has no area%s",
                          args[LIGHT_EMISSION].given ? " and gives no light" : "");
    return make_area_light(context, &light, args, result, error);
}

static bool gr_spherical_light(struct script_context *context, const struct script_value *args,
                               struct script_result *result, struct error *error) {
    struct light light = {
        .kind = LIGHT_SPHERE, .position = args[BALL_POSITION].vector, .radius = args[BALL_RADIUS].number};
    return make_area_light(context, &light, args, result, error);
}

static bool gr_disc_light(struct script_context *context, const struct script_value *args, struct script_result *result,
                          struct error *error) {
    struct light light = {.kind = LIGHT_DISC,
                          .position = args[PANEL_POSITION].vector,
                          .radius = args[PANEL_RADIUS].number,
                          .one_sided = args[PANEL_ONE_SIDED].boolean};
    return set_direction(&light, args[PANEL_NORMAL].vector, "normal", error) &&
           make_area_light(context, &light, args, result, error);
}

static bool gr_mesh_light(struct script_context *context, const struct script_value *args, struct script_result *result,
                          struct error *error) {
    struct light light = {.kind = LIGHT_MESH,
                          .emissive = true,
                          .samples = (int)args[MESHLIGHT_SAMPLES].number,
                          .has_emission = args[MESHLIGHT_EMISSION].given,
                          .emission = args[MESHLIGHT_EMISSION].colour};
    struct script_value area_light[MESHLIGHT_COUNT];
    for (int i = 0; i < MESHLIGHT_COUNT; i++)
        area_light[i] = args[i];
    if (!args[LIGHT_COLOUR].given)
        area_light[LIGHT_COLOUR].colour = colour_all(1);
    if (!give_light(context, &light, area_light, result, error))
        return false;
    ((struct scene_light *)result->pointer)->node = args[MESHLIGHT_MESH].node;
    return true;
}

static bool gr_sky_light(struct script_context *context, const struct script_value *args, struct script_result *result,
                         struct error *error) {
    struct light light = {.kind = LIGHT_SKY, .emissive = true, .samples = (int)args[SKYLIGHT_SAMPLES].number};
    struct sky *sky = arena_alloc(&context->scene.arena, sizeof *sky);
    struct script_value area_light[SKYLIGHT_COUNT];
    if (!sky)
        return error_no_memory(error, "a sky");
    *sky = (struct sky){.kind = SKY_GRADIENT};
    if (args[SKYLIGHT_SKY].text && strcmp(args[SKYLIGHT_SKY].text, "transparent") == 0)
        return error_set(error, ERROR_SCENE, "sky: what is transparent is no light");
    if (args[SKYLIGHT_SKY].program && !sky_from_function(args[SKYLIGHT_SKY].program, sky, error))
        return false;
    if (args[SKYLIGHT_SKY].sky)
        *sky = *args[SKYLIGHT_SKY].sky;
    else if (!args[SKYLIGHT_SKY].text && !args[SKYLIGHT_SKY].program)
        *sky = (struct sky){
            .kind = SKY_CONSTANT, .colour = args[SKYLIGHT_SKY].colour, .display = args[SKYLIGHT_SKY].display};
    light.sky = sky;
    for (int i = 0; i < SKYLIGHT_COUNT; i++)
        area_light[i] = args[i];
    if (!args[LIGHT_COLOUR].given)
        area_light[LIGHT_COLOUR].colour = colour_all(1);
    return give_light(context, &light, area_light, result, error);
}

/* The rows of the table. */
static const struct script_function rows[] = {
    GR("light", light_parameters, RESULT_LIGHT, gr_light, "A point light.", "position colour falloff?"),
    GR("area_light", area_parameters, RESULT_LIGHT, gr_area_light, "A parallelogram as a light, with soft shadows.",
       "corner v1 v2 colour falloff?"),
    GR("spherical_light", ball_light_parameters, RESULT_LIGHT, gr_spherical_light,
       "A sphere as a light, with soft shadows.", "position colour falloff radius"),
    GR("disc_light", disc_light_parameters, RESULT_LIGHT, gr_disc_light, "A disc as a light, with soft shadows.",
       "position normal radius colour falloff?"),
    GR("directional_light", directional_parameters, RESULT_LIGHT, gr_directional_light,
       "A light at infinity: all its rays are parallel.", "direction colour"),
    GR("spot_light", spot_parameters, RESULT_LIGHT, gr_spot_light, "A point light that shines into a cone.",
       "position direction colour inner outer falloff?"),

    GR("mesh_light", mesh_light_parameters, RESULT_LIGHT, gr_mesh_light, "The triangles of a mesh as a light.",
       "mesh emission?"),
    GR("sky_light", sky_light_parameters, RESULT_LIGHT, gr_sky_light,
       "A sky as a light; bright parts get more shadow rays.", "sky"),
};

const struct function_rows light_functions = {rows, COUNT(rows)};
