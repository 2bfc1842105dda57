/* gr.render. */
#include "image/transfer.h"
#include "math/elementary.h"
#include "script/bindings_internal.h"
#include "script/lenient_internal.h"

static bool choose_sky(struct script_context *context, const struct script_value *args, struct sky *sky,
                       struct error *error) {
    /* Scenes in the table form alone are of today: their background is light and neutral, that of others navy. */
    static const double neutral[][4] = {{-1, 0.62, 0.61, 0.6}, {0, 0.8, 0.81, 0.82}, {1, 0.9, 0.93, 0.96}};
    const struct script_value *background = &args[RENDER_BACKGROUND];
    *sky = (struct sky){.kind = SKY_GRADIENT};
    if (context->only_named_pictures && !background->given)
        *sky = (struct sky){.kind = SKY_STOPS, .stops = neutral, .stop_count = 3};
    if (args[RENDER_SKY].given && background->given)
        return error_set(error, ERROR_SCENE, "sky and background exclude each other");
    if (args[RENDER_SKY].given) {
        struct image *image = gr_find_image(context, &args[RENDER_SKY], error);
        return image && sky_from_cross(image, args[RENDER_MIRROR].boolean, sky, error);
    }
    if (background->program)
        return sky_from_function(background->program, sky, error);
    if (background->sky) {
        *sky = *background->sky;
    } else if (background->given && !background->text) {
        sky->kind = SKY_CONSTANT;
        sky->colour = background->vector;
        sky->display = background->display;
    }
    return true;
}

/* The named fields of the call have priority over the command line. */
static void apply_settings(const struct script_value *args, struct settings *settings) {
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
    if (args[RENDER_INTEGRATOR].given)
        settings->integrator = (enum integrator_kind)args[RENDER_INTEGRATOR].choice;
    if (args[RENDER_SPP].given && settings->path_samples == 0) /* here the option wins */
        settings->path_samples = (int)args[RENDER_SPP].number;
    if (args[RENDER_MAX_DEPTH].given)
        settings->max_depth = (int)args[RENDER_MAX_DEPTH].number;
    if (args[RENDER_NOISE].given && settings->noise == 0) /* so it does here */
        settings->noise = args[RENDER_NOISE].number;
    if (args[RENDER_CLAMP].given)
        settings->clamp = args[RENDER_CLAMP].number;
    if (args[RENDER_FILTER].given)
        settings->filter = (enum filter_kind)args[RENDER_FILTER].choice;
    if (args[RENDER_DENOISE].given && args[RENDER_DENOISE].boolean && settings->denoise == DENOISER_NONE)
        settings->denoise = DENOISER_GRAY;
    if (args[RENDER_COLOUR].given)
        settings->colour = (enum colour_pipeline)args[RENDER_COLOUR].choice;
    /* Linear colours are shown by the sRGB curve. */
    if (settings_linear(settings) && !args[RENDER_SRGB].given)
        settings->tone.srgb = true;
}

static bool apply_lens(const struct script_value *args, struct lens *lens, const struct camera *camera,
                       struct error *error) {
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

static bool apply_motion(const struct script_value *args, struct settings *settings, const struct camera *camera,
                         struct error *error) {
    if (args[RENDER_VIEW_TO].given && args[RENDER_TARGET].given)
        return error_set(error, ERROR_SCENE, "view_to needs view, and target_to needs target");
    if (args[RENDER_TARGET_TO].given && !args[RENDER_TARGET].given)
        return error_set(error, ERROR_SCENE, "target_to needs target");
    if (args[RENDER_SHUTTER].given)
        settings->shutter = (struct shutter){args[RENDER_SHUTTER].vector.x, args[RENDER_SHUTTER].vector.y};
    const struct script_value *eye = &args[RENDER_EYE_TO], *up = &args[RENDER_UP_TO];
    const struct script_value *view = &args[args[RENDER_TARGET].given ? RENDER_TARGET_TO : RENDER_VIEW_TO];
    settings->motion = (struct camera_motion){.moves = eye->given || view->given || up->given,
                                              .eye = eye->given ? eye->vector : camera->eye,
                                              .view = view->given ? view->vector : camera->view,
                                              .up = up->given ? up->vector : camera->up};
    return true;
}

/* Stock scenes have a view of zero: they look at the origin. */
static void repair_view(struct script_context *context, const struct script_value *args,
                        struct render_request *request) {
    struct camera *camera = &request->camera;
    bool is_target = request->settings.view_is_target;
    if (!is_target && vec3_max_abs(camera->view) == 0) {
        bool at_origin = vec3_max_abs(camera->eye) == 0;
        camera->view = at_origin ? vec3_make(0, 0, -1) : vec3_negate(camera->eye);
        context_warn_once(context, WARNED_OTHER, "view is zero: the camera looks %s",
                          at_origin ? "along -z" : "at the origin");
    }
    if (is_target && context->lenient && vec3_max_abs(vec3_sub(camera->view, camera->eye)) == 0) {
        camera->view = vec3_add(camera->eye, vec3_make(0, 0, -1));
        lenient_warn(context, "%s is where the eye is: the camera looks along -z",
                     args[RENDER_TARGET].given ? "target" : "view");
    }
}

bool gr_render(struct script_context *context, const struct script_value *args, struct script_result *result,
               struct error *error) {
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
    const struct transfer_function srgb = {TRANSFER_SRGB, 0};
    struct camera fitted;
    if (context->lenient && !args[RENDER_EYE].given) {
        lenient_camera(request.root, &fitted);
        request.camera = fitted;
    }
    request.sky_chosen = args[RENDER_SKY].given || args[RENDER_BACKGROUND].given;
    apply_settings(args, &request.settings);
    repair_view(context, args, &request);
    bool linear = settings_linear(&request.settings);
    if (linear && args[RENDER_AMBIENT].display)
        request.ambient = transfer_decode_colour(srgb, request.ambient);
    if (linear && request.fog && request.fog->display) {
        struct fog *fog = arena_alloc(&context->scene.arena, sizeof *fog);
        if (!fog)
            return error_no_memory(error, "a fog");
        *fog = *request.fog;
        fog->colour = transfer_decode_colour(srgb, fog->colour);
        fog->display = false;
        request.fog = fog;
    }
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
    context->pictures += done;
    return done;
}
