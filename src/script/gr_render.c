/* gr.render. */
#include "base/file.h"
#include "compat/lenient.h"
#include "compat/lenient_picture.h"
#include "image/picture_file.h"
#include "image/transfer.h"
#include "material/medium_mix.h"
#include "record/record_bounds.h"
#include "scene/node_bounds.h"
#include "script/gr_materials_internal.h"
#include "script/rows_internal.h"
#include "script/scene_write_internal.h"
#include "script/script_internal.h"
#include "script/studio_internal.h"
#include "settings/setting.h"

#include <string.h>

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
    RENDER_FIRST_SETTING,
    RENDER_LAST_SETTING = RENDER_FIRST_SETTING + LIST_COUNT(SETTINGS_WITH_FIELD) - 1,
    RENDER_FOG,
    RENDER_MEDIUM,
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
    RENDER_ROWS,
    RENDER_COLUMNS,
    RENDER_SIZE,
    RENDER_SPACING,
    RENDER_DEPTH,
    RENDER_SHUTTER,
    RENDER_EYE_TO,
    RENDER_VIEW_TO,
    RENDER_TARGET_TO,
    RENDER_UP_TO,
    RENDER_MODEL,
    RENDER_COUNT
};

/* The parameter of a setting: its type, range and words by its kind. */
#define PARAMETER_FLAG(low, high, list) KIND_BOOLEAN, OPTIONAL, 0, 0, NULL
#define PARAMETER_WHOLE(low, high, list) KIND_WHOLE, OPTIONAL, low, high, NULL
#define PARAMETER_NUMBER(low, high, list) KIND_NUMBER, OPTIONAL, low, high, LIST_BLANKS(list)
#define PARAMETER_SEED(low, high, list) KIND_WHOLE, OPTIONAL, low, high, NULL
#define PARAMETER_CHOICE(low, high, list) KIND_CHOICE, OPTIONAL, 0, 0, LIST_BLANKS(list)
#define PARAMETER_TONE(low, high, list) KIND_CHOICE, OPTIONAL | OR_CURVE, 0, 0, LIST_BLANKS(list)
#define PARAMETER_DENOISE(low, high, list) KIND_BOOLEAN, OPTIONAL, 0, 0, NULL
#define PARAMETER_CAUSTICS(low, high, list) KIND_CAUSTICS, OPTIONAL, 0, 0, NULL
#define PARAMETER_OF_SETTING(kind, type, member, change, initial, low, high, list, option, value, unit, field, ...)    \
    {field, PARAMETER_##kind(low, high, list), unit, option, FIRST_HELP(__VA_ARGS__)},
#define FIRST_HELP(words, group, ...) HELP_OF(__VA_ARGS__, 0)
#define HELP_OF(help, ...) help

_Static_assert((int)RENDER_COUNT <= (int)PARAMETER_LIMIT, "no function has more parameters than gr.render");
static const struct script_parameter render_parameters[] = {
    [RENDER_NODE] = {"node", KIND_NODE, 0, ANY, NULL, NULL, "Root node of the picture."},
    [RENDER_FILE] = {"file", KIND_OUTPUT, OPTIONAL, ANY, NULL, "SCRIPT.png",
                     "Picture file:" PICTURE_FORMATS_HELP "; gray creates missing folders."},
    [RENDER_SKY] = {"sky", KIND_IMAGE, OPTIONAL | OR_SKY, ANY, NULL, NULL,
                    "Background that is also light: a sky, or a picture of the whole sphere, twice as wide as high. A "
                    "picture with six views in a 4 x 3 cross is background only."},
    [RENDER_WIDTH] = {"width", KIND_WHOLE, OPTIONAL, 1, 1 << 20, NULL, "pixels", "960", "Width of the picture."},
    [RENDER_HEIGHT] = {"height", KIND_WHOLE, OPTIONAL, 1, 1 << 20, NULL, "pixels", "9/16 of width",
                       "Height of the picture."},
    [RENDER_EYE] = {"eye", KIND_POINT, OPTIONAL, ANY, NULL, "fits the scene", "Position of the camera."},
    [RENDER_VIEW] = {"view", KIND_DIRECTION, OPTIONAL, ANY, NULL, "{0, 0, -1}", "Direction of view."},
    [RENDER_UP] = {"up", KIND_DIRECTION, OPTIONAL, ANY, NULL, "{0, 1, 0}", "Direction that is up in the picture."},
    [RENDER_FOV] = {"fov", KIND_NUMBER, OPTIONAL | LOW_OPEN | HIGH_OPEN, 0, 180, NULL, "degrees", "50",
                    "Full vertical angle of view."},
    [RENDER_AMBIENT] = {"ambient", KIND_COLOUR, OPTIONAL | OR_DISPLAY, ANY, NULL, "{0, 0, 0}", "Ambient light."},
    [RENDER_LIGHTS] = {"lights", KIND_LIGHTS, OPTIONAL, ANY, NULL, "{}", "The lights."},
    [RENDER_TARGET] = {"target", KIND_POINT, OPTIONAL, ANY, NULL, NULL, "Point to look at, instead of view."},
    [RENDER_BACKGROUND] =
        {"background", KIND_BACKGROUND, OPTIONAL, ANY, NULL, "'gradient'",
         "Background for rays that hit nothing: a colour, a sky, a function of the unit direction, "
         "'gradient' for {0, 0, (1 + y)/2}, or 'transparent': the picture has alpha, and only mirrors, "
         "glass and light see sky or the default. If all pictures of the script have the form "
         "gr.render{...} without background, the default is light and neutral."},
    [RENDER_MIRROR] = {"mirror", KIND_BOOLEAN, OPTIONAL, ANY, NULL, "false", "Whether the sky cross is mirrored."},
    SETTINGS_WITH_FIELD(PARAMETER_OF_SETTING)[RENDER_FOG] = {"fog", KIND_FOG, OPTIONAL, ANY, NULL, "none", "A fog."},
    [RENDER_MEDIUM] = {"medium", KIND_MEDIUM, OPTIONAL, ANY, NULL, "none",
                       "A medium around all solids, instead of a fog."},
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
                       "Distance along the view where both eyes, or all views of a light field, see the same point of "
                       "the picture."},
    [RENDER_ROWS] = {"rows", KIND_WHOLE, OPTIONAL, IN_RANGE(1, LIGHT_FIELD_SIDE), NULL, "9 of gr.light_field",
                     "Rows of a light field: a grid of views, each of width x height pixels, in one file."},
    [RENDER_COLUMNS] = {"columns", KIND_WHOLE, OPTIONAL, IN_RANGE(1, LIGHT_FIELD_SIDE), NULL, "9 of gr.light_field",
                        "Its columns."},
    [RENDER_SIZE] = {"size", KIND_PAIR, OPTIONAL, IN_RANGE(1, 1 << 20), "pixels", "width, height",
                     "Both in one table: {width, height}; a number alone is a square."},
    [RENDER_SPACING] = {"spacing", KIND_NUMBER, OPTIONAL, ABOVE(0), NULL, "screen / 100",
                        "Distance between neighbouring cameras of a light field."},
    [RENDER_DEPTH] = {"depth", KIND_BOOLEAN, OPTIONAL, ANY, NULL, "false",
                      "Whether a light field keeps the depths of its pixels."},
    [RENDER_SHUTTER] = {"shutter", KIND_INTERVAL, OPTIONAL, ANY, NULL, "{0, 1}",
                        "Times when the shutter opens and closes, {open, close}; motion between them is blurred."},
    [RENDER_EYE_TO] = {"eye_to", KIND_POINT, OPTIONAL, ANY, NULL, "eye", "Position of a moving camera at time 1."},
    [RENDER_VIEW_TO] = {"view_to", KIND_DIRECTION, OPTIONAL, ANY, NULL, "view", "Its direction of view at time 1."},
    [RENDER_TARGET_TO] = {"target_to", KIND_POINT, OPTIONAL, ANY, NULL, "target", "The point to look at, at time 1."},
    [RENDER_UP_TO] = {"up_to", KIND_DIRECTION, OPTIONAL, ANY, NULL, "up", "Its up direction at time 1."},
    [RENDER_MODEL] = {"model", KIND_NODE, OPTIONAL, ANY, NULL, "node",
                      "What -o MODEL writes and --check-print checks, without the ground of the picture."},
};

static bool is_transparent(const struct script_value *background) {
    return background->text && strcmp(background->text, "transparent") == 0;
}

/* *shines: the sky of the field `sky` is also light. */
static bool choose_sky(struct script_context *context, const struct script_value *args, struct sky *sky, bool *shines,
                       struct error *error) {
    /* Scenes that use only the table form are new ones: their default background is light and neutral, that of other
     * scenes is navy. */
    static const double neutral[][4] = {{-1, 0.62, 0.61, 0.6}, {0, 0.8, 0.81, 0.82}, {1, 0.9, 0.93, 0.96}};
    const struct script_value *background = &args[RENDER_BACKGROUND];
    bool transparent = is_transparent(background);
    *sky = (struct sky){.kind = SKY_GRADIENT};
    if (script_of(context)->only_named_pictures && (!background->given || transparent))
        *sky = (struct sky){.kind = SKY_STOPS, .stops = neutral, .stop_count = 3};
    if (args[RENDER_SKY].given && background->given && !transparent)
        return error_set(error, ERROR_SCENE, "sky and background exclude each other");
    *shines = args[RENDER_SKY].sky != NULL;
    if (*shines) {
        *sky = *args[RENDER_SKY].sky;
        return true;
    }
    if (args[RENDER_SKY].given) {
        struct image *image = gr_find_image(context, &args[RENDER_SKY], error);
        *shines = image && image_width(image) == 2 * image_height(image);
        if (*shines)
            *sky = (struct sky){.kind = SKY_MAP, .image = image};
        return image && (*shines || sky_from_cross(image, args[RENDER_MIRROR].boolean, sky, error));
    }
    if (background->program)
        return sky_from_function(background->program, sky, error);
    if (background->sky) {
        *sky = *background->sky;
    } else if (background->given && !background->text) {
        sky->kind = SKY_CONSTANT;
        sky->colour = background->colour;
        sky->display = background->display;
    }
    return true;
}

/* Adds the sky to the lights, unless a sky is there. */
static bool add_sky_light(struct script_context *context, struct render_request *request, struct error *error) {
    uint32_t count = request->light_count;
    for (uint32_t i = 0; i < count; i++)
        if (request->lights[i].light.kind == LIGHT_SKY)
            return true;
    struct scene_light *lights = arena_alloc_array(&context->sandbox.call, (size_t)count + 1, sizeof *lights);
    struct sky *sky = arena_alloc(&context->sandbox.call, sizeof *sky);
    if (!lights || !sky)
        return error_no_memory(error, "a sky");
    if (count > 0)
        memcpy(lights, request->lights, count * sizeof *lights);
    *sky = request->sky;
    lights[count].light = (struct light){.kind = LIGHT_SKY, .emissive = true, .colour = {1, 1, 1}, .sky = sky};
    request->lights = lights;
    request->light_count = count + 1;
    return true;
}

static void apply_setting(const struct setting *row, const struct script_value *value, struct settings *settings) {
    switch (row->kind) {
    case SETTING_FLAG:
        setting_store(row, settings, value->boolean);
        break;
    case SETTING_WHOLE:
    case SETTING_NUMBER:
    case SETTING_SEED:
        setting_store(row, settings, value->number);
        break;
    case SETTING_CHOICE:
        setting_store(row, settings, value->choice);
        break;
    case SETTING_TONE:
        settings->tone.curve = value->curve ? TONE_FUNCTION : (enum tone_curve)value->choice;
        settings->tone.table = value->curve;
        break;
    case SETTING_DENOISE:
        settings->denoise = value->boolean ? DENOISER_GRAY : DENOISER_NONE;
        break;
    case SETTING_CAUSTICS:
        settings->caustics = (struct caustics){(int)value->number, value->vector.x};
        break;
    case SETTING_LAYERS:
    case SETTING_CROP:
    case SETTING_STATS:
        OPTION_KINDS(LIST_LABEL)
        break; /* options only */
    }
}

/* Who chose a setting; later ones have priority. A field `seed` has priority over --seed, which also seeds
 * math.random. */
enum chooser { CHOSEN_BY_DEFAULT, CHOSEN_BY_FIELD, CHOSEN_BY_OPTION };

static enum chooser chooser_of(const struct script_options *options, const struct script_value *args, int index) {
    bool has_field = args[RENDER_FIRST_SETTING + index].given;
    bool may_win = setting_table[index].kind != SETTING_SEED || !has_field;
    if (script_option_given(options, index) && may_win)
        return CHOSEN_BY_OPTION;
    return has_field ? CHOSEN_BY_FIELD : CHOSEN_BY_DEFAULT;
}

/* Of two settings that exclude each other the one with priority stays. If both have the same, the renderer reports
 * them. */
static void drop_rival(const struct script_options *options, const struct script_value *args,
                       struct render_request *request) {
    int loser = SETTING_INDEX(style), winner = setting_rival(loser);
    enum chooser of_loser = chooser_of(options, args, loser), of_winner = chooser_of(options, args, winner);
    if (!settings_exclude(&request->settings) || of_loser == of_winner)
        return;
    if (of_loser > of_winner) {
        loser = winner;
        of_loser = of_winner;
    }
    setting_store(&setting_table[loser], &request->settings, setting_table[loser].initial);
    if (of_loser == CHOSEN_BY_FIELD)
        request->replaced |= UINT64_C(1) << loser;
}

static void apply_settings(const struct script_options *options, const struct script_value *args,
                           struct render_request *request) {
    struct settings *settings = &request->settings;
    for (int i = 0; i < setting_field_count; i++) {
        if (!args[RENDER_FIRST_SETTING + i].given)
            continue;
        struct settings with_field = *settings;
        apply_setting(&setting_table[i], &args[RENDER_FIRST_SETTING + i], &with_field);
        if (chooser_of(options, args, i) == CHOSEN_BY_FIELD)
            *settings = with_field;
        else if (!settings_equal(settings, &with_field))
            request->replaced |= UINT64_C(1) << i;
    }
    drop_rival(options, args, request);
    if (args[RENDER_TARGET].given)
        settings->view_is_target = true;
    /* Linear colours are shown by the sRGB curve. */
    int srgb = SETTING_INDEX(tone.srgb);
    if (settings_linear(settings) && !args[RENDER_FIRST_SETTING + srgb].given && !script_option_chosen(options, srgb))
        settings->tone.srgb = true;
}
_Static_assert(LIST_COUNT(SETTINGS_WITH_FIELD) <= 64, "every field of a setting has a bit of a mask");

/* A field that has no effect without another one gets a notice, once for each line. */
static void note_lone_fields(struct script_context *context, const struct script_value *args) {
    const struct {
        int field, needs;
        int choice; /* that it must be; -1: any */
        const char *words;
    } pairs[] = {{RENDER_BLADES, RENDER_APERTURE, -1, ""},
                 {RENDER_BLADE_ANGLE, RENDER_BLADES, -1, ""},
                 {RENDER_EYE_DISTANCE, RENDER_STEREO, -1, ""},
                 {RENDER_SCREEN, args[RENDER_COLUMNS].given ? RENDER_COLUMNS : RENDER_STEREO, -1, ""},
                 {RENDER_SPACING, RENDER_COLUMNS, -1, ""},
                 {RENDER_DEPTH, RENDER_COLUMNS, -1, ""},
                 {RENDER_MIRROR, RENDER_SKY, -1, ""},
                 {RENDER_VIEW_HEIGHT, RENDER_PROJECTION, PROJECTION_ORTHOGRAPHIC, " = 'orthographic'"},
                 {RENDER_ANGLE, RENDER_PROJECTION, PROJECTION_FISHEYE, " = 'fisheye'"}};
    char where[PATH_SIZE + 32], text[PATH_SIZE + 256];
    for (size_t i = 0; i < COUNT(pairs); i++) {
        const struct script_value *needed = &args[pairs[i].needs];
        bool has = needed->given && (pairs[i].choice < 0 || needed->choice == pairs[i].choice);
        if (!args[pairs[i].field].given || has || !sandbox_is_new_line(&context->sandbox, render_parameters))
            continue;
        sandbox_where(&context->sandbox, where, sizeof where);
        (void)snprintf(text, sizeof text, "%sgr.render: %s has no effect without %s%s", where,
                       render_parameters[pairs[i].field].name, render_parameters[pairs[i].needs].name, pairs[i].words);
        sandbox_message(&context->sandbox, SCRIPT_NOTICE, text);
        return;
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
    lens->rows = (int)args[RENDER_ROWS].number;
    lens->columns = (int)args[RENDER_COLUMNS].number;
    lens->spacing = args[RENDER_SPACING].given ? args[RENDER_SPACING].number : lens->screen / 100;
    lens->depth = args[RENDER_DEPTH].boolean && lens->columns > 0;
    lens->fov = camera->fov;
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
    return vec3_add_scaled(camera->eye, view, math_max(along, 0));
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
    const struct frame_options *options = &context->sandbox.options->frames;
    struct render_request request = *first;
    struct scene_light lights[STUDIO_LIGHTS];
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
        if (context->scene.studio && !first->changed) /* the light of a studio turns with the camera */
            studio_light(&request, context->scene.is_model, lights);
        if (!host->render(host->context, &request, error))
            return false;
    }
    return true;
}

/* The name of a picture without `file`: that of the script, with a number if there are several. False: no memory. */
static bool name_picture(struct script_context *context, const char *extension, struct script_value *file) {
    struct script *script = script_of(context);
    char end[32], name[PATH_SIZE];
    uint32_t number = ++script->unnamed, namesakes = script->host->namesakes;
    bool numbered = script->several_pictures || number > 1;
    if (numbered)
        (void)snprintf(end, sizeof end, "-%u%s", (unsigned)number, extension);
    else
        (void)snprintf(end, sizeof end, "%s", extension);
    context_picture_name(context, end, name, sizeof name);
    if (script->context.scene.is_model && (namesakes > 0 || assets_has_image(context->scene.assets, name))) {
        (void)snprintf(end, sizeof end, namesakes > 1 ? "-render-%u.png" : "-render.png", (unsigned)namesakes);
        context_picture_name(context, end, name, sizeof name);
    }
    *file = (struct script_value){.given = true, .text = arena_format(&context->sandbox.call, "%s", name)};
    return file->text != NULL;
}

static void set_number(struct script_value *value, double number) {
    *value = value->given ? *value : (struct script_value){.given = true, .number = number};
}

static void set_vector(struct script_value *value, struct vec3 vector) {
    *value = value->given ? *value : (struct script_value){.given = true, .vector = vector};
}

/* The fields of a camera that shows the whole scene. */
static void fit_camera(const struct script_context *context, struct script_value *args) {
    enum { FIELD_OF_VIEW = 30 };
    const struct script_host *host = script_of(context)->host;
    double width = host->width > 0 ? host->width : args[RENDER_WIDTH].number;
    double height = host->height > 0 ? host->height : args[RENDER_HEIGHT].number;
    set_number(&args[RENDER_FOV], FIELD_OF_VIEW);
    const struct framing framing = {.view = args[RENDER_VIEW].vector,
                                    .up = args[RENDER_UP].vector,
                                    .fov = args[RENDER_FOV].number,
                                    .aspect = width / height,
                                    .target = args[RENDER_TARGET].given ? &args[RENDER_TARGET].vector : NULL};
    struct node *fitted = script_of(context)->fitted;
    struct framed framed = studio_frame(fitted ? fitted : args[RENDER_NODE].node, &framing);
    bool has_direction = args[RENDER_VIEW].given || args[RENDER_VIEW_TO].given;
    set_vector(&args[RENDER_EYE], framed.eye);
    if (has_direction)
        set_vector(&args[RENDER_VIEW], vec3_sub(framed.target, framed.eye));
    else
        set_vector(&args[RENDER_TARGET], framed.target);
    if (has_direction && !args[RENDER_FOCUS_POINT].given)
        set_number(&args[RENDER_FOCUS], framed.distance);
    set_number(&args[RENDER_VIEW_HEIGHT], framed.view_height);
}

/* --sky takes the place of sky and background. */
static bool use_sky_of_command_line(struct script_context *context, struct script_value *args, struct error *error) {
    const char *sky = context->sandbox.options->sky;
    char path[PATH_SIZE];
    if (!sky)
        return true;
    if (!file_canonical(sky, path, sizeof path)) {
        error_set(error, ERROR_SCENE, "--sky: cannot find '%.600s'", sky);
        return error_elsewhere(error);
    }
    const char *text = arena_format(&context->sandbox.call, "%s", path);
    args[RENDER_SKY] = (struct script_value){.given = true, .text = text};
    args[RENDER_BACKGROUND] = args[RENDER_MIRROR] = (struct script_value){0};
    return text || error_no_memory(error, "a sky");
}

/* Fills in what a picture may leave out. Positional pictures of --lenient have a camera of their own. */
static bool complete(struct script_context *context, struct script_value *args, struct error *error) {
    enum { WIDTH = 960 };
    bool has_size = args[RENDER_SIZE].given, is_field = args[RENDER_ROWS].given || args[RENDER_COLUMNS].given;
    if (has_size && (args[RENDER_WIDTH].given || args[RENDER_HEIGHT].given))
        return error_set(error, ERROR_SCENE, "size and width, height exclude each other");
    if (has_size) {
        struct vec3 size = args[RENDER_SIZE].vector;
        if (size.x != floor(size.x) || size.y != floor(size.y))
            return error_set(error, ERROR_SCENE, "size must be whole numbers of pixels");
        set_number(&args[RENDER_WIDTH], size.x);
        set_number(&args[RENDER_HEIGHT], size.y);
    }
    if (!args[RENDER_FILE].given && !name_picture(context, is_field ? ".lf" : ".png", &args[RENDER_FILE]))
        return error_no_memory(error, "a picture");
    if (is_field) {
        set_number(&args[RENDER_ROWS], 1);
        set_number(&args[RENDER_COLUMNS], 1);
    }
    set_number(&args[RENDER_WIDTH], args[RENDER_HEIGHT].given ? ceil(args[RENDER_HEIGHT].number * 16 / 9) : WIDTH);
    set_number(&args[RENDER_HEIGHT], ceil(args[RENDER_WIDTH].number * 9 / 16));
    if (!args[RENDER_EYE].given && !(context->lenient && !script_of(context)->only_named_pictures))
        fit_camera(context, args);
    return true;
}

/* Lights a picture that would have no light at all, with one notice. */
static bool light_dark_picture(struct script_context *context, const struct script_value *args,
                               struct render_request *request, struct scene_light lights[STUDIO_LIGHTS],
                               struct error *error) {
    struct script *script = script_of(context);
    struct scene *scene = &context->scene;
    bool studio = script->only_named_pictures && !args[RENDER_LIGHTS].given && !args[RENDER_AMBIENT].given &&
                  (!args[RENDER_BACKGROUND].given || is_transparent(&args[RENDER_BACKGROUND])) &&
                  !args[RENDER_SKY].given;
    if (studio && !script->context.scene.is_model &&
        !studio_is_dark(scene, request->root, &context->sandbox.call, &studio, error))
        return false;
    if (scene->studio != studio)
        scene_note_change(scene);
    scene->studio = studio;
    if (!studio)
        return true;
    studio_light(request, script->context.scene.is_model, lights);
    if (script->studio_noticed || script->host->repeats || script->context.scene.is_model)
        return true;
    script->studio_noticed = true;
    char text[PATH_SIZE + 256];
    (void)snprintf(text, sizeof text,
                   "%s: the scene has no light, so that of a studio shows it; lights={...} replaces it",
                   request->where);
    sandbox_message(&context->sandbox, SCRIPT_NOTICE, text);
    return true;
}

static bool gr_render(struct script_context *context, const struct script_value *given, struct script_result *result,
                      struct error *error) {
    struct script_value args[RENDER_COUNT];
    struct node *fitted_node = script_of(context)->fitted;
    (void)result;
    memcpy(args, given, sizeof args);
    /* Arguments that are missing are completed. */
    if (args[RENDER_VIEW].given && args[RENDER_TARGET].given)
        return error_set(error, ERROR_SCENE, "view and target exclude each other");
    if (!use_sky_of_command_line(context, args, error) || !complete(context, args, error))
        return false;
    /* The request as the arguments state it. */
    char where[PATH_SIZE + 32], title[96];
    sandbox_where(&context->sandbox, where, sizeof where);
    const char *call = arena_format(&context->sandbox.call, "%s%s", where, function_title(context->function, title));
    if (!call)
        return error_no_memory(error, "a picture");
    struct render_request request = {
        .where = call,
        .scene = &context->scene,
        .root = args[RENDER_NODE].node,
        .subject = args[RENDER_MODEL].given ? args[RENDER_MODEL].node
                   : fitted_node            ? fitted_node
                                            : args[RENDER_NODE].node,
        .file = args[RENDER_FILE].text,
        .width = args[RENDER_WIDTH].number,
        .height = args[RENDER_HEIGHT].number,
        .camera = {.eye = args[RENDER_EYE].vector,
                   .view = args[RENDER_TARGET].given ? args[RENDER_TARGET].vector
                           : args[RENDER_VIEW].given ? args[RENDER_VIEW].vector
                                                     : (struct vec3){0, 0, -1},
                   .up = args[RENDER_UP].given ? args[RENDER_UP].vector : (struct vec3){0, 1, 0},
                   .fov = args[RENDER_FOV].given ? args[RENDER_FOV].number : 50},
        .ambient = args[RENDER_AMBIENT].colour,
        .lights = args[RENDER_LIGHTS].lights,
        .light_count = args[RENDER_LIGHTS].count,
        .settings = script_of(context)->host->settings,
        .frame = script_of(context)->animation.frame,
    };
    request.time = request.frame.number > 0 ? frame_time(&request.frame) : script_of(context)->time;
    /* Settings of the program, then those of the call. */
    const struct transfer_function srgb = {TRANSFER_SRGB, 0};
    struct scene_light lights[STUDIO_LIGHTS];
    struct camera fitted;
    bool shines = false;
    if (context->lenient && !args[RENDER_EYE].given) {
        lenient_camera(request.root, &fitted);
        request.camera = fitted;
    }
    request.sky_chosen = args[RENDER_SKY].given || args[RENDER_BACKGROUND].given;
    apply_settings(context->sandbox.options, args, &request);
    for (int i = 0; i < setting_field_count; i++)
        request.fields |= (uint64_t)args[RENDER_FIRST_SETTING + i].given << i;
    /* What the fields mean together. */
    note_lone_fields(context, given);
    repair_view(context, args, &request);
    context_warn_of_bytes(context, "ambient", request.ambient);
    if (args[RENDER_BACKGROUND].given)
        context_warn_of_bytes(context, "background", args[RENDER_BACKGROUND].colour);
    /* The linear pipeline decodes colours of the screen. */
    bool linear = settings_linear(&request.settings);
    if (linear && args[RENDER_AMBIENT].display)
        request.ambient = transfer_decode_colour(srgb, request.ambient);
    const struct fog *fog = args[RENDER_FOG].fog;
    if (linear && fog && fog->display) {
        struct fog *decoded = arena_alloc(&context->scene.arena, sizeof *decoded);
        if (!decoded)
            return error_no_memory(error, "a fog");
        *decoded = *fog;
        decoded->colour = transfer_decode_colour(srgb, fog->colour);
        decoded->display = false;
        fog = decoded;
    }
    if (fog && args[RENDER_MEDIUM].given)
        return error_set(error, ERROR_SCENE, "fog and medium are both around the solids; give one of them");
    if (args[RENDER_MEDIUM].given && medium_needs_solid(args[RENDER_MEDIUM].material->medium))
        return error_set(error, ERROR_SCENE, "the grid of the medium needs corner and size, for it fills no solid");
    request.outside =
        args[RENDER_MEDIUM].given ? medium_without_solid(args[RENDER_MEDIUM].material->medium) : medium_outside(fog);
    /* Functions, lens, motion, sky and light. */
    if (!record_check(&context->sandbox, &context->scene, request.root, error) ||
        (args[RENDER_MODEL].given && !record_check(&context->sandbox, &context->scene, request.subject, error)) ||
        !apply_lens(args, &request.settings.lens, &request.camera, error) ||
        !apply_motion(args, &script_of(context)->animation.frame, script_of(context)->animation.shutter,
                      &request.settings, &request.camera, error) ||
        !choose_sky(context, args, &request.sky, &shines, error) ||
        (shines && !add_sky_light(context, &request, error)) ||
        !light_dark_picture(context, args, &request, lights, error))
        return false;
    /* The picture is rendered with the saved changes; its time does not count as the script's. */
    struct changed_scene changed;
    if (!changes_begin(context, &request, &changed, error))
        return false;
    request.changed = script_of(context)->changes.count > 0;
    request.settings.transparent = is_transparent(&args[RENDER_BACKGROUND]);
    limits_pause(&context->sandbox.limits);
    bool turns = context->sandbox.options->frames.turntable > 0;
    bool done = context->noted ? scene_write_picture(context, &request, error)
                : turns        ? render_turntable(context, &request, error)
                               : script_of(context)->host->render(script_of(context)->host->context, &request, error);
    limits_resume(&context->sandbox.limits);
    changes_remove(&changed);
    script_of(context)->pictures += done;
    return done;
}

static bool gr_light_field(struct script_context *context, const struct script_value *given,
                           struct script_result *result, struct error *error) {
    enum { SIDE = 9 };
    struct script_value args[RENDER_COUNT];
    memcpy(args, given, sizeof args);
    set_number(&args[RENDER_ROWS], SIDE);
    set_number(&args[RENDER_COLUMNS], SIDE);
    return gr_render(context, args, result, error);
}

#define RENDER_TAIL " width height eye view up fov ambient? lights?"

static const struct script_function render_rows[] = {
    GR("render", render_parameters, RESULT_NOTHING, gr_render, "Renders a picture into a file.",
       "node file" RENDER_TAIL),
    GR("render_skybox", render_parameters, RESULT_NOTHING, gr_render, "The same as gr.render, with a sky picture.",
       "node file sky" RENDER_TAIL),
    GR("light_field", render_parameters, RESULT_NOTHING, gr_light_field,
       "Renders a light field: the pictures of a grid of cameras, in one file.", "node file"),
};
const struct function_rows render_functions = {render_rows, COUNT(render_rows)};

static const struct script_function render_method_rows[] = {
    NODE("render", render_parameters, RESULT_NOTHING, gr_render, "The same as gr.render with this node.",
         "file" RENDER_TAIL),
};
const struct function_rows render_method_functions = {render_method_rows, COUNT(render_method_rows)};
