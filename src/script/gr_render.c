/* gr.render. */
#include "compat/lenient.h"
#include "compat/lenient_picture.h"
#include "image/transfer.h"
#include "math/elementary.h"
#include "record/record_bounds.h"
#include "scene/node_bounds.h"
#include "script/bindings_internal.h"
#include "script/script_internal.h"

static bool choose_sky(struct script_context *context, const struct script_value *args, struct sky *sky,
                       struct error *error) {
    /* Scenes that use only the table form are new ones: their default background is light and neutral, that of other
     * scenes is navy. */
    static const double neutral[][4] = {{-1, 0.62, 0.61, 0.6}, {0, 0.8, 0.81, 0.82}, {1, 0.9, 0.93, 0.96}};
    const struct script_value *background = &args[RENDER_BACKGROUND];
    *sky = (struct sky){.kind = SKY_GRADIENT};
    if (script_of(context)->only_named_pictures && !background->given)
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
    const struct script_value *tone = &args[RENDER_TONE];
    if (tone->curve && !settings->keeps_tone) { /* here the option has priority */
        settings->tone.curve = TONE_FUNCTION;
        settings->tone.table = tone->curve;
    } else if (tone->given && !tone->curve) {
        settings->tone.curve = (enum tone_curve)tone->choice;
    }
    if (args[RENDER_SRGB].given)
        settings->tone.srgb = args[RENDER_SRGB].boolean;
    if (args[RENDER_DEEP].given)
        settings->deep = args[RENDER_DEEP].boolean;
    if (args[RENDER_STYLE].given)
        settings->style = (enum style)args[RENDER_STYLE].choice;
    if (args[RENDER_LINE_WIDTH].given)
        settings->line_width = args[RENDER_LINE_WIDTH].number;
    if (args[RENDER_TOON_STEPS].given)
        settings->toon_steps = (int)args[RENDER_TOON_STEPS].number;
    if (args[RENDER_BLOOM].given)
        settings->finish.bloom = args[RENDER_BLOOM].number;
    if (args[RENDER_VIGNETTE].given)
        settings->finish.vignette = args[RENDER_VIGNETTE].number;
    if (args[RENDER_GRAY].given)
        settings->finish.gray = args[RENDER_GRAY].boolean;
    if (args[RENDER_EDGES].given)
        settings->finish.edges = args[RENDER_EDGES].boolean;
    if (args[RENDER_FXAA].given)
        settings->finish.fxaa = args[RENDER_FXAA].boolean;
    if (args[RENDER_DITHER].given)
        settings->finish.dither = (enum dither)args[RENDER_DITHER].choice;
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
    if (args[RENDER_DENOISE].given && args[RENDER_DENOISE].boolean && settings->denoise == DENOISER_NONE &&
        !settings->keeps_noise)
        settings->denoise = DENOISER_GRAY;
    if (args[RENDER_COLOUR].given)
        settings->colour = (enum colour_pipeline)args[RENDER_COLOUR].choice;
    /* Linear colours are shown by the sRGB curve. */
    if (settings_linear(settings) && !args[RENDER_SRGB].given)
        settings->tone.srgb = true;
}

/* One notice for each option of the command line that the call has overridden. */
static void note_overridden(struct script_context *context, const struct settings *settings) {
    const struct script_options *options = script_of(context)->options;
    const char *asked = (const char *)&script_of(context)->host->settings, *used = (const char *)settings;
    for (int i = 0; i < options->given_count && i < 64 && !script_of(context)->host->repeats; i++) {
        const struct given_option *given = &options->given[i];
        char where[PATH_SIZE + 32], text[PATH_SIZE + 256];
        if (script_of(context)->overridden >> i & 1 ||
            memcmp(asked + given->offset, used + given->offset, given->size) == 0)
            continue;
        script_of(context)->overridden |= UINT64_C(1) << i;
        sandbox_where(&context->sandbox, where, sizeof where);
        (void)snprintf(text, sizeof text, "%s%.*s%s%.64s has no effect: a field of gr.render sets it", where,
                       (int)strcspn(given->name, "|"), given->name, given->value ? " " : "",
                       given->value ? given->value : "");
        sandbox_message(&context->sandbox, SCRIPT_NOTICE, text);
    }
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

/* shutter: that of the animation of the frame. */
static bool apply_motion(const struct script_value *args, const struct frame *frame, struct shutter shutter,
                         struct settings *settings, const struct camera *camera, struct error *error) {
    if (args[RENDER_VIEW_TO].given && args[RENDER_TARGET].given)
        return error_set(error, ERROR_SCENE, "view_to needs view, and target_to needs target");
    if (args[RENDER_TARGET_TO].given && !args[RENDER_TARGET].given)
        return error_set(error, ERROR_SCENE, "target_to needs target");
    if (args[RENDER_SHUTTER].given)
        settings->shutter = (struct shutter){args[RENDER_SHUTTER].vector.x, args[RENDER_SHUTTER].vector.y};
    else if (frame->number > 0)
        settings->shutter = shutter;
    if (frame->number > 0) { /* frames to seconds; a picture outside of animations is a frame of one second */
        settings->shutter.open /= frame->rate;
        settings->shutter.close /= frame->rate;
    }
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

/* The centre of a turntable: the point of the line of sight that is nearest to the centre of the scene. */
static struct vec3 turntable_middle(const struct render_request *request, struct vec3 view) {
    const struct camera *camera = &request->camera;
    struct box box = box_empty();
    struct error ignored;
    if (request->settings.view_is_target)
        return camera->view;
    bool bounded = node_bounds(request->root, &box, &ignored) && !box_is_empty(&box) && vec3_finite(box.min) &&
                   vec3_finite(box.max);
    struct vec3 centre = bounded ? vec3_scale(vec3_add(box.min, box.max), 0.5) : vec3_all(0);
    double length = vec3_dot(view, view);
    double along = length > 0 ? vec3_dot(vec3_sub(centre, camera->eye), view) / length : 0;
    return vec3_add_scaled(camera->eye, view, fmax(along, 0));
}

/* Rotates the camera, and the poses that it moves to, about the line of `up` through the centre. */
static void turn_camera(struct render_request *request, const struct render_request *first, struct vec3 middle,
                        double degrees) {
    struct transform turn = transform_rotate_about(first->camera.up, degrees);
    bool is_target = first->settings.view_is_target;
    const struct vec3 *from[] = {&first->camera.eye, &first->camera.view, &first->settings.motion.eye,
                                 &first->settings.motion.view};
    struct vec3 *to[] = {&request->camera.eye, &request->camera.view, &request->settings.motion.eye,
                         &request->settings.motion.view};
    for (int i = 0; i < 4; i++) {
        bool is_direction = i % 2 == 1 && !is_target;
        struct vec3 origin = is_direction ? vec3_all(0) : middle;
        *to[i] = vec3_add(affine_vector(&turn.forward, vec3_sub(*from[i], origin)), origin);
    }
    request->settings.motion.up = affine_vector(&turn.forward, first->settings.motion.up);
    if (first->settings.lens.focus == 0)
        request->settings.lens.focus_point =
            vec3_add(affine_vector(&turn.forward, vec3_sub(first->settings.lens.focus_point, middle)), middle);
}

/* --turntable: renders the pictures of one call. Without it, `render` renders one picture. */
static bool render_turntable(struct script_context *context, const struct render_request *first, struct error *error) {
    const struct frame_options *options = &script_of(context)->options->frames;
    struct render_request request = *first;
    struct vec3 middle = turntable_middle(first, first->camera.view);
    uint32_t count = (uint32_t)options->turntable;
    if (vec3_max_abs(first->camera.up) == 0)
        return error_set(error, ERROR_SCENE, "--turntable needs an up of another length than 0");
    if (options->selection.step > 0 && options->selection.last > count)
        return error_set(error, ERROR_SCENE, "--frames selects frame %u, but the last frame is %u",
                         options->selection.last, count);
    const struct script_host *host = script_of(context)->host;
    request.frame = (struct frame){0, count, options->rate > 0 ? options->rate : FRAME_RATE_DEFAULT, .loops = true,
                                   .before = script_of(context)->pictures * count};
    while ((request.frame.number = host->next_frame ? host->next_frame(host->context, &request.frame)
                                                    : frame_after(&options->selection, &request.frame)) > 0) {
        turn_camera(&request, first, middle, 360.0 * (request.frame.number - 1) / count);
        if (!host->render(host->context, &request, error))
            return false;
    }
    return true;
}

bool gr_render(struct script_context *context, const struct script_value *args, struct script_result *result,
               struct error *error) {
    (void)result;
    if (args[RENDER_VIEW].given && args[RENDER_TARGET].given)
        return error_set(error, ERROR_SCENE, "view and target exclude each other");
    char where[PATH_SIZE + 32], title[96];
    sandbox_where(&context->sandbox, where, sizeof where);
    const char *call = arena_format(&context->sandbox.call, "%s%s", where, function_title(context->function, title));
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
        .settings = script_of(context)->host->settings,
        .frame = script_of(context)->animation.frame,
    };
    const struct transfer_function srgb = {TRANSFER_SRGB, 0};
    struct camera fitted;
    if (context->lenient && !args[RENDER_EYE].given) {
        lenient_camera(request.root, &fitted);
        request.camera = fitted;
    }
    request.sky_chosen = args[RENDER_SKY].given || args[RENDER_BACKGROUND].given;
    apply_settings(args, &request.settings);
    note_overridden(context, &request.settings);
    repair_view(context, args, &request);
    context_warn_of_bytes(context, "ambient", request.ambient);
    if (args[RENDER_BACKGROUND].given)
        context_warn_of_bytes(context, "background", args[RENDER_BACKGROUND].vector);
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
    if (!record_check(&context->sandbox, &context->scene, request.root, error) ||
        !apply_lens(args, &request.settings.lens, &request.camera, error) ||
        !apply_motion(args, &script_of(context)->animation.frame, script_of(context)->animation.shutter,
                      &request.settings, &request.camera, error) ||
        !choose_sky(context, args, &request.sky, error))
        return false;
    struct changed_scene changed;
    if (!changes_begin(context, &request, &changed, error))
        return false;
    request.changed = script_of(context)->changes.count > 0;
    limits_pause(&context->sandbox.limits);
    bool turns = script_of(context)->options->frames.turntable > 0;
    bool done = turns ? render_turntable(context, &request, error)
                      : script_of(context)->host->render(script_of(context)->host->context, &request, error);
    limits_resume(&context->sandbox.limits);
    changes_take_off(&changed);
    script_of(context)->pictures += done;
    return done;
}
