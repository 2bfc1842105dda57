/* gr.render. */
#include "image/transfer.h"
#include "math/elementary.h"
#include "scene/node_bounds.h"
#include "script/bindings_internal.h"
#include "script/lenient_internal.h"
#include "settings/setting.h"

static bool choose_sky(struct script_context *context, const struct script_value *args, struct sky *sky,
                       struct error *error) {
    /* Scenes that use only the table form are new ones: their default background is light and neutral, that of other
     * scenes is navy. */
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

/* Whether the option has priority over the field. */
static bool option_wins(const struct setting *row, const struct settings *settings) {
    bool is_one =
        row->offset == offsetof(struct settings, path_samples) || row->offset == offsetof(struct settings, noise);
    return is_one && setting_bits(row, settings) != 0;
}

static void apply_setting(const struct setting *row, const struct script_value *value, struct settings *settings) {
    switch (row->kind) {
    case SETTING_FLAG:
        setting_store(row, settings, value->boolean);
        break;
    case SETTING_WHOLE:
    case SETTING_NUMBER:
    case SETTING_SEED:
        if (!option_wins(row, settings))
            setting_store(row, settings, value->number);
        break;
    case SETTING_CHOICE:
        setting_store(row, settings, value->choice);
        break;
    case SETTING_TONE:
        if (!value->curve) {
            settings->tone.curve = (enum tone_curve)value->choice;
        } else if (!settings->keeps_tone) { /* over functions the option has priority */
            settings->tone.curve = TONE_FUNCTION;
            settings->tone.table = value->curve;
        }
        break;
    case SETTING_DENOISE:
        if (value->boolean && settings->denoise == DENOISER_AUTO)
            settings->denoise = DENOISER_GRAY;
        break;
    case SETTING_CAUSTICS:
        settings->caustics = (struct caustics){(int)value->number, value->vector.x};
        break;
    case SETTING_LAYERS:
    case SETTING_CROP:
    case SETTING_STATS:
    case SETTING_BYTES:
    case SETTING_TEXT:
    case SETTING_SIZE:
    case SETTING_SHARD:
    case SETTING_FRAMES:
    case SETTING_ACTION:
    case SETTING_PIXEL:
    case SETTING_DEFINE:
    case SETTING_FOLDER:
        break; /* options only */
    }
}

/* The named fields of the call have priority over the command line. */
static void apply_settings(const struct script_value *args, struct settings *settings) {
    for (int i = 0; i < setting_field_count; i++) {
        if (args[RENDER_FIRST_SETTING + i].given)
            apply_setting(&setting_table[i], &args[RENDER_FIRST_SETTING + i], settings);
    }
    if (args[RENDER_TARGET].given)
        settings->view_is_target = true;
    /* Linear colours are shown by the sRGB curve. */
    if (settings_linear(settings) && !args[RENDER_FIRST_SETTING + SETTING_INDEX(tone.srgb)].given)
        settings->tone.srgb = true;
}

/* One notice for each option of the command line that the call has overridden. --seed has none: it also seeds
 * math.random. */
static void note_overridden(struct script_context *context, const struct settings *settings) {
    const char *const *given = context->options->given;
    for (int i = 0; i < setting_count && given && !context->host->repeats; i++) {
        const struct setting *row = &setting_table[i];
        char where[PATH_SIZE + 32], text[PATH_SIZE + 256];
        if (!given[i] || row->kind == SETTING_SEED || context->overridden >> i & 1 ||
            setting_bits(row, &context->host->settings) == setting_bits(row, settings))
            continue;
        context->overridden |= UINT64_C(1) << i;
        context_where(context, where, sizeof where);
        (void)snprintf(text, sizeof text, "%s%.*s%s%.64s has no effect: a field of gr.render sets it", where,
                       (int)strcspn(row->option, "|"), row->option, given[i][0] ? " " : "", given[i]);
        context->host->message(context->host->context, SCRIPT_NOTICE, text);
    }
}
_Static_assert(LIST_COUNT(SETTINGS) <= 64, "every setting has a bit of overridden");

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
    const struct frame_options *options = &context->options->frames;
    struct render_request request = *first;
    struct vec3 middle = turntable_middle(first, first->camera.view);
    uint32_t count = (uint32_t)options->turntable;
    if (vec3_max_abs(first->camera.up) == 0)
        return error_set(error, ERROR_SCENE, "--turntable needs an up of another length than 0");
    if (options->selection.step > 0 && options->selection.last > count)
        return error_set(error, ERROR_SCENE, "--frames selects frame %u, but the last frame is %u",
                         options->selection.last, count);
    const struct script_host *host = context->host;
    request.frame = (struct frame){0, count, options->rate > 0 ? options->rate : FRAME_RATE_DEFAULT, .loops = true,
                                   .before = context->pictures * count};
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
        .frame = context->frame,
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
    if (!record_check(context, request.root, error) ||
        !apply_lens(args, &request.settings.lens, &request.camera, error) ||
        !apply_motion(args, &context->frame, context->frame_shutter, &request.settings, &request.camera, error) ||
        !choose_sky(context, args, &request.sky, error))
        return false;
    struct changed_scene changed;
    if (!changes_begin(context, &request, &changed, error))
        return false;
    request.changed = context->change_count > 0;
    limits_pause(context);
    bool turns = context->options->frames.turntable > 0;
    bool done = turns ? render_turntable(context, &request, error)
                      : context->host->render(context->host->context, &request, error);
    limits_resume(context);
    changes_take_off(&changed);
    context->pictures += done;
    return done;
}
