/* Lights, and the call that everything is for. */
#include "math/elementary.h"
#include "script/actions.h"
#include "script/context.h"

/* The nodes of a list, kept as long as the scene. */
static bool keep_nodes(struct context *context, const struct value *value, const struct node *const **nodes,
                       uint32_t *count) {
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

/* What every light has, and the light itself into the arena of the scene. */
static bool give_light(struct context *context, struct light *light, const struct value *args, struct result *result,
                       struct error *error) {
    struct light *kept = arena_alloc(&context->scene.arena, sizeof *kept);
    light->colour = args[LIGHT_COLOUR].vector;
    if (!kept || !keep_nodes(context, &args[LIGHT_INCLUDE], &light->include, &light->include_count) ||
        !keep_nodes(context, &args[LIGHT_EXCLUDE], &light->exclude, &light->exclude_count))
        return error_no_memory(error, "a light");
    *kept = *light;
    result->pointer = kept;
    return true;
}

static bool set_fading(struct light *light, const struct value *args, struct error *error) {
    struct vec3 c = args[LIGHT_FALLOFF].given ? args[LIGHT_FALLOFF].vector : (struct vec3){1, 0, 0};
    if (args[LIGHT_FALLOFF].given + args[LIGHT_RANGE].given + args[LIGHT_INTENSITY].given > 1)
        return error_set(error, ERROR_SCENE, "falloff, range and intensity exclude each other");
    light->falloff[0] = c.x;
    light->falloff[1] = c.y;
    light->falloff[2] = c.z;
    light->range = args[LIGHT_RANGE].number;
    light->intensity = args[LIGHT_INTENSITY].number;
    light->fading = args[LIGHT_RANGE].given       ? FADING_RANGE
                    : args[LIGHT_INTENSITY].given ? FADING_INVERSE_SQUARE
                                                  : FADING_COEFFICIENTS;
    return true;
}

/* A light with an extent: fading as from its centre, or a lamp whose surface emits. */
static bool give_lamp(struct context *context, struct light *light, const struct value *args, struct result *result,
                      struct error *error) {
    struct value lamp[LIGHT_OWN];
    for (int i = 0; i < LIGHT_OWN; i++)
        lamp[i] = args[i];
    light->emits = args[LIGHT_EMISSION].given;
    light->samples = (int)args[LIGHT_SAMPLES].number;
    light->visible = args[LIGHT_VISIBLE].boolean;
    if (!args[LIGHT_COLOUR].given && !light->emits)
        return error_set(error, ERROR_SCENE, "colour is missing");
    if (light->emits && (args[LIGHT_FALLOFF].given || args[LIGHT_RANGE].given || args[LIGHT_INTENSITY].given))
        return error_set(error, ERROR_SCENE,
                         "a light with emission fades by its shape alone, without falloff, range "
                         "or intensity");
    if (light->emits && !args[LIGHT_COLOUR].given)
        lamp[LIGHT_COLOUR].vector = vec3_all(1);
    if (light->emits)
        lamp[LIGHT_COLOUR].vector = vec3_mul(lamp[LIGHT_COLOUR].vector, args[LIGHT_EMISSION].vector);
    return set_fading(light, args, error) && give_light(context, light, lamp, result, error);
}

static bool set_direction(struct light *light, struct vec3 direction, const char *name, struct error *error) {
    if (!(vec3_length(direction) > 0))
        return error_set(error, ERROR_SCENE, "%s must not be zero", name);
    light->direction = vec3_normalize(direction);
    return true;
}

bool act_light(struct context *context, const struct value *args, struct result *result, struct error *error) {
    struct light light = {.kind = LIGHT_POINT, .position = args[POINT_POSITION].vector};
    return set_fading(&light, args, error) && give_light(context, &light, args, result, error);
}

bool act_directional_light(struct context *context, const struct value *args, struct result *result,
                           struct error *error) {
    struct light light = {.kind = LIGHT_DIRECTIONAL};
    return set_direction(&light, args[DISTANT_DIRECTION].vector, "direction", error) &&
           give_light(context, &light, args, result, error);
}

bool act_spot_light(struct context *context, const struct value *args, struct result *result, struct error *error) {
    struct light light = {.kind = LIGHT_SPOT, .position = args[SPOT_POSITION].vector};
    const struct value *inner = &args[SPOT_INNER], *outer = &args[SPOT_OUTER];
    if (args[SPOT_DIRECTION].given && args[SPOT_TARGET].given)
        return error_set(error, ERROR_SCENE, "direction and target exclude each other");
    double outer_angle = outer->given ? outer->number : inner->given && inner->number > 30 ? inner->number : 30;
    double inner_angle = inner->given ? inner->number : 0.75 * outer_angle;
    if (inner_angle > outer_angle)
        return error_set(error, ERROR_SCENE, "inner must be at most outer, the angle where the light ends");
    const double degree = 3.14159265358979323846 / 180;
    light.cos_inner = el_cos(inner_angle * degree);
    light.cos_outer = el_cos(outer_angle * degree);
    struct vec3 axis = args[SPOT_TARGET].given      ? vec3_sub(args[SPOT_TARGET].vector, light.position)
                       : args[SPOT_DIRECTION].given ? args[SPOT_DIRECTION].vector
                                                    : (struct vec3){0, -1, 0};
    return set_direction(&light, axis, args[SPOT_TARGET].given ? "the way to target" : "direction", error) &&
           set_fading(&light, args, error) && give_light(context, &light, args, result, error);
}

bool act_area_light(struct context *context, const struct value *args, struct result *result, struct error *error) {
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
    return give_lamp(context, &light, args, result, error);
}

bool act_spherical_light(struct context *context, const struct value *args, struct result *result,
                         struct error *error) {
    struct light light = {
        .kind = LIGHT_SPHERE, .position = args[BALL_POSITION].vector, .radius = args[BALL_RADIUS].number};
    return give_lamp(context, &light, args, result, error);
}

bool act_disc_light(struct context *context, const struct value *args, struct result *result, struct error *error) {
    struct light light = {.kind = LIGHT_DISC,
                          .position = args[PANEL_POSITION].vector,
                          .radius = args[PANEL_RADIUS].number,
                          .one_sided = args[PANEL_ONE_SIDED].boolean};
    return set_direction(&light, args[PANEL_NORMAL].vector, "normal", error) &&
           give_lamp(context, &light, args, result, error);
}

bool act_mesh_light(struct context *context, const struct value *args, struct result *result, struct error *error) {
    struct light light = {.kind = LIGHT_MESH,
                          .emits = true,
                          .node = args[MESHLIGHT_MESH].node,
                          .samples = (int)args[MESHLIGHT_SAMPLES].number,
                          .has_emission = args[MESHLIGHT_EMISSION].given,
                          .emission = args[MESHLIGHT_EMISSION].vector};
    struct value lamp[MESHLIGHT_COUNT];
    for (int i = 0; i < MESHLIGHT_COUNT; i++)
        lamp[i] = args[i];
    if (!args[LIGHT_COLOUR].given)
        lamp[LIGHT_COLOUR].vector = vec3_all(1);
    return give_light(context, &light, lamp, result, error);
}

bool act_sky_light(struct context *context, const struct value *args, struct result *result, struct error *error) {
    struct light light = {.kind = LIGHT_SKY, .emits = true, .samples = (int)args[SKYLIGHT_SAMPLES].number};
    struct sky *sky = arena_alloc(&context->scene.arena, sizeof *sky);
    struct value lamp[SKYLIGHT_COUNT];
    if (!sky)
        return error_no_memory(error, "a sky");
    *sky = (struct sky){.kind = SKY_GRADIENT};
    if (args[SKYLIGHT_SKY].sky)
        *sky = *args[SKYLIGHT_SKY].sky;
    else if (!args[SKYLIGHT_SKY].text)
        *sky = (struct sky){.kind = SKY_CONSTANT, .colour = args[SKYLIGHT_SKY].vector};
    light.sky = sky;
    for (int i = 0; i < SKYLIGHT_COUNT; i++)
        lamp[i] = args[i];
    if (!args[LIGHT_COLOUR].given)
        lamp[LIGHT_COLOUR].vector = vec3_all(1);
    return give_light(context, &light, lamp, result, error);
}

static bool choose_sky(struct context *context, const struct value *args, struct sky *sky, struct error *error) {
    const struct value *background = &args[RENDER_BACKGROUND];
    *sky = (struct sky){.kind = SKY_GRADIENT};
    if (args[RENDER_SKY].given && background->given)
        return error_set(error, ERROR_SCENE, "sky and background exclude each other");
    if (args[RENDER_SKY].given) {
        struct image *image = act_find_image(context, &args[RENDER_SKY], error);
        return image && sky_from_cross(image, args[RENDER_MIRROR].boolean, sky, error);
    }
    if (background->sky) {
        *sky = *background->sky;
    } else if (background->given && !background->text) {
        sky->kind = SKY_CONSTANT;
        sky->colour = background->vector;
    }
    return true;
}

/* The named fields of the call win over the command line. */
static void apply_settings(const struct value *args, struct settings *settings) {
    if (args[RENDER_SAMPLES].given)
        settings->samples = (int)args[RENDER_SAMPLES].number;
    if (args[RENDER_FULL].given)
        settings->full = args[RENDER_FULL].boolean;
    if (args[RENDER_AREA_SAMPLES].given)
        settings->area_samples = (int)args[RENDER_AREA_SAMPLES].number;
    if (args[RENDER_REFLECT_LIMIT].given)
        settings->reflect_limit = (int)args[RENDER_REFLECT_LIMIT].number;
    if (args[RENDER_REFRACT_LIMIT].given)
        settings->refract_limit = (int)args[RENDER_REFRACT_LIMIT].number;
    if (args[RENDER_SIDE_TOLERANCE].given)
        settings->side_tolerance = args[RENDER_SIDE_TOLERANCE].number;
    if (args[RENDER_CORNER_TOLERANCE].given)
        settings->corner_tolerance = args[RENDER_CORNER_TOLERANCE].number;
    if (args[RENDER_USE_TIR].given)
        settings->use_tir = args[RENDER_USE_TIR].boolean;
    if (args[RENDER_SPECULAR].given)
        settings->specular = (enum specular_kind)args[RENDER_SPECULAR].choice;
    if (args[RENDER_SEED].given)
        settings->seed = (uint64_t)args[RENDER_SEED].number;
    if (args[RENDER_ACCEL].given)
        settings->accel = (enum accel_kind)args[RENDER_ACCEL].choice;
    if (args[RENDER_TARGET].given)
        settings->view_is_target = true;
    if (args[RENDER_EXPOSURE].given)
        settings->tone.exposure = args[RENDER_EXPOSURE].number;
    if (args[RENDER_TONE].given)
        settings->tone.curve = (enum tone_curve)args[RENDER_TONE].choice;
    if (args[RENDER_SRGB].given)
        settings->tone.srgb = args[RENDER_SRGB].boolean;
    if (args[RENDER_DEEP].given)
        settings->deep = args[RENDER_DEEP].boolean;
    if (args[RENDER_CAUSTICS].given)
        settings->caustics = (struct caustics){(int)args[RENDER_CAUSTICS].number, args[RENDER_CAUSTICS].vector.x};
    if (args[RENDER_CUTOFF].given)
        settings->cutoff = args[RENDER_CUTOFF].number;
}

static bool apply_lens(const struct value *args, struct lens *lens, const struct camera *camera, struct error *error) {
    if (args[RENDER_FOCUS].given && args[RENDER_FOCUS_POINT].given)
        return error_set(error, ERROR_SCENE, "focus and focus_point exclude each other");
    if (args[RENDER_PROJECTION].given)
        lens->projection = (enum projection)args[RENDER_PROJECTION].choice;
    if (args[RENDER_VIEW_HEIGHT].given)
        lens->view_height = args[RENDER_VIEW_HEIGHT].number;
    if (args[RENDER_ANGLE].given)
        lens->angle = args[RENDER_ANGLE].number;
    lens->shift_x = args[RENDER_SHIFT_X].number;
    lens->shift_y = args[RENDER_SHIFT_Y].number;
    lens->aperture = args[RENDER_APERTURE].number;
    double to_target = vec3_length(vec3_sub(args[RENDER_TARGET].vector, camera->eye));
    double fallback = args[RENDER_TARGET].given && to_target > 0 ? to_target : 1;
    lens->focus = args[RENDER_FOCUS].given ? args[RENDER_FOCUS].number : args[RENDER_FOCUS_POINT].given ? 0 : fallback;
    lens->focus_point = args[RENDER_FOCUS_POINT].vector;
    lens->blades = (int)args[RENDER_BLADES].number;
    lens->blade_angle = args[RENDER_BLADE_ANGLE].number;
    lens->stereo = (enum stereo)args[RENDER_STEREO].choice;
    lens->screen = args[RENDER_SCREEN].given ? args[RENDER_SCREEN].number : lens->focus > 0 ? lens->focus : fallback;
    lens->eye_distance = args[RENDER_EYE_DISTANCE].given ? args[RENDER_EYE_DISTANCE].number : lens->screen / 30;
    return true;
}

static bool apply_motion(const struct value *args, struct settings *settings, const struct camera *camera,
                         struct error *error) {
    if (args[RENDER_VIEW_TO].given && args[RENDER_TARGET].given)
        return error_set(error, ERROR_SCENE, "view_to goes with view, target_to with target");
    if (args[RENDER_TARGET_TO].given && !args[RENDER_TARGET].given)
        return error_set(error, ERROR_SCENE, "target_to needs target");
    if (args[RENDER_SHUTTER].given)
        settings->shutter = (struct shutter){args[RENDER_SHUTTER].vector.x, args[RENDER_SHUTTER].vector.y};
    const struct value *eye = &args[RENDER_EYE_TO], *up = &args[RENDER_UP_TO];
    const struct value *view = &args[args[RENDER_TARGET].given ? RENDER_TARGET_TO : RENDER_VIEW_TO];
    settings->motion = (struct camera_motion){.moves = eye->given || view->given || up->given,
                                              .eye = eye->given ? eye->vector : camera->eye,
                                              .view = view->given ? view->vector : camera->view,
                                              .up = up->given ? up->vector : camera->up};
    return true;
}

bool act_render(struct context *context, const struct value *args, struct result *result, struct error *error) {
    (void)result;
    if (args[RENDER_VIEW].given && args[RENDER_TARGET].given)
        return error_set(error, ERROR_SCENE, "view and target exclude each other");
    char where[PATH_SIZE + 32], title[96];
    context_where(context, where, sizeof where);
    const char *call = arena_format(&context->call, "%s%s", where, function_title(context->function, title));
    if (!call)
        return error_no_memory(error, "a picture");
    struct render_request request = {
        .where = call,
        .scene = &context->scene,
        .root = args[RENDER_NODE].node,
        .file = args[RENDER_FILE].text,
        .width = args[RENDER_WIDTH].number,
        .height = args[RENDER_HEIGHT].number,
        .camera = {.eye = args[RENDER_EYE].vector,
                   .view = args[RENDER_TARGET].given ? args[RENDER_TARGET].vector
                           : args[RENDER_VIEW].given ? args[RENDER_VIEW].vector
                                                     : (struct vec3){0, 0, -1},
                   .up = args[RENDER_UP].given ? args[RENDER_UP].vector : (struct vec3){0, 1, 0},
                   .fov = args[RENDER_FOV].given ? args[RENDER_FOV].number : 50},
        .ambient = args[RENDER_AMBIENT].vector,
        .lights = args[RENDER_LIGHTS].lights,
        .light_count = args[RENDER_LIGHTS].count,
        .fog = args[RENDER_FOG].fog,
        .settings = context->host->settings,
    };
    apply_settings(args, &request.settings);
    if (!apply_lens(args, &request.settings.lens, &request.camera, error) ||
        !apply_motion(args, &request.settings, &request.camera, error) ||
        !choose_sky(context, args, &request.sky, error))
        return false;
    struct changed_scene changed;
    if (!changes_begin(context, &request, &changed, error))
        return false;
    limits_pause(context);
    bool done = context->host->render(context->host->context, &request, error);
    limits_resume(context);
    changes_take_off(&changed);
    return done;
}
