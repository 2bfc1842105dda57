/* Lights, and the call that everything is for. */
#include "script/actions.h"
#include "script/context.h"

static bool give_light(struct context *context, const struct light *light, struct result *result, struct error *error) {
    struct light *kept = arena_alloc(&context->scene.arena, sizeof *kept);
    if (!kept)
        return error_no_memory(error, "a light");
    *kept = *light;
    result->pointer = kept;
    return true;
}

static void set_falloff(struct light *light, const struct value *falloff) {
    struct vec3 c = falloff->given ? falloff->vector : (struct vec3){1, 0, 0};
    light->falloff[0] = c.x;
    light->falloff[1] = c.y;
    light->falloff[2] = c.z;
}

bool act_light(struct context *context, const struct value *args, struct result *result, struct error *error) {
    struct light light = {
        .kind = LIGHT_POINT, .position = args[LIGHT_POSITION].vector, .colour = args[LIGHT_COLOUR].vector};
    set_falloff(&light, &args[LIGHT_FALLOFF]);
    return give_light(context, &light, result, error);
}

bool act_area_light(struct context *context, const struct value *args, struct result *result, struct error *error) {
    struct light light = {.kind = LIGHT_PARALLELOGRAM,
                          .corner = args[AREA_CORNER].vector,
                          .edge1 = args[AREA_V1].vector,
                          .edge2 = args[AREA_V2].vector,
                          .colour = args[AREA_COLOUR].vector};
    light.position = vec3_add_scaled(vec3_add_scaled(light.corner, light.edge1, 0.5), light.edge2, 0.5);
    set_falloff(&light, &args[AREA_FALLOFF]);
    return give_light(context, &light, result, error);
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
    if (background->given && !background->text) {
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
        settings->specular = args[RENDER_SPECULAR].choice == 0 ? SPECULAR_PHONG : SPECULAR_BLINN;
    if (args[RENDER_SEED].given)
        settings->seed = (uint64_t)args[RENDER_SEED].number;
    if (args[RENDER_ACCEL].given)
        settings->accel = (enum accel_kind)args[RENDER_ACCEL].choice; /* listed in the order of the enum */
    if (args[RENDER_TARGET].given)
        settings->view_is_target = true;
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
        .settings = context->host->settings,
    };
    apply_settings(args, &request.settings);
    if (!choose_sky(context, args, &request.sky, error))
        return false;
    limits_pause(context);
    bool done = context->host->render(context->host->context, &request, error);
    limits_resume(context);
    return done;
}
