/* A path of eyes or directions has one point for each frame, linear between those of the command line. The files are
 * those of a run: atomic, and they replace only pictures. */
#include "output/view.h"

#include "base/file.h"
#include "base/mem.h"
#include "image/image.h"
#include "image/png_write.h"
#include "math/elementary.h"
#include "output/animation.h"
#include "render/camera.h"
#include "session/text.h"

#include <stdlib.h>
#include <string.h>

enum { PANORAMA_WIDTH = 640, PANORAMA_HEIGHT = 480, PANORAMA_FOV = 50 };

/* --- the command line --- */

/* "X,Y,Z:X,Y,Z"; a number that is missing at the end is 0. */
static bool read_points(struct view *view, const char *option, const char *text, uint32_t numbers,
                        struct error *error) {
    for (const char *at = text; view->point_count < VIEW_POINTS;) {
        double v[3] = {0, 0, 0};
        uint32_t count = 0;
        for (char *end; count < numbers; at = end + 1) {
            v[count++] = strtod(at, &end);
            if (end == at || !isfinite(v[count - 1]))
                return error_set(error, ERROR_USAGE, "%s %.600s: needs numbers with commas between them", option, text);
            at = end;
            if (*end != ',')
                break;
        }
        view->points[view->point_count++] = vec3_make(v[0], v[1], v[2]);
        if (*at == '\0' && count >= 2)
            return true;
        if (*at != ':' || count < 2)
            return error_set(error, ERROR_USAGE, "%s %.600s: needs %s, and ':' between several", option, text,
                             numbers == 3 ? "X,Y or X,Y,Z" : "LON,LAT");
        at++;
    }
    return error_set(error, ERROR_USAGE, "%s: a path has at most %d points", option, VIEW_POINTS);
}

static bool check_options(const struct view *view, struct error *error) {
    const struct options *options = view->options;
    const char *of_field = options->eyes            ? "--eye"
                           : options->focus > 0     ? "--focus"
                           : options->aperture > 0  ? "--aperture"
                           : options->contact_sheet ? "--contact-sheet"
                                                    : NULL;
    const char *of_panorama = options->directions ? "--direction" : options->fov > 0 ? "--fov" : NULL;
    const char *name = options->scripts[0], *wrong = view->is_field ? of_panorama : of_field;
    bool animates = options->animation != ANIMATION_NONE;
    if (!options->output && !options->window)
        return error_set(error, ERROR_USAGE, "view needs -o FILE, or -gui");
    if (options->window && (options->output || options->contact_sheet || view->frames > 1))
        return error_set(error, ERROR_USAGE, "-gui shows a view: no -o, --contact-sheet or --frames");
    if (wrong)
        return error_set(error, ERROR_USAGE, "%s is not for %.600s, which is a %s", wrong, name,
                         view->is_field ? "light field" : "panorama");
    if (view->frames > 1 && !animates && !output_name_numbered(options->output))
        return error_set(error, ERROR_USAGE, "-o %.600s: frames need an animation, such as x.gif, or a name with %%d",
                         options->output);
    if (animates && options_output_is_stream(options))
        return error_set(error, ERROR_USAGE, "-o -: an animation needs the name of a file");
    return !options->contact_sheet || (!animates && !options->width && !options->eyes && view->frames == 1) ||
           error_set(error, ERROR_USAGE, "--contact-sheet is one picture of all views: no --size, --eye or --frames");
}

/* --- the file --- */

static bool open_panorama(struct view *view, struct error *error) {
    const char *name = view->options->scripts[0];
    struct error reason = {0};
    view->image = image_read(name, error);
    if (!view->image)
        return false;
    view->sky = (struct sky){.kind = SKY_MAP, .image = view->image};
    bool is_map = image_width(view->image) == 2 * image_height(view->image);
    if (!is_map && !sky_from_cross(view->image, false, &view->sky, &reason))
        return error_set(error, ERROR_SCENE,
                         "%.600s: is %u x %u; a panorama is twice as wide as high, or a 4 x 3 cross of six faces", name,
                         image_width(view->image), image_height(view->image));
    view->tone.srgb = image_bits(view->image) == 32;
    view->width = PANORAMA_WIDTH;
    view->height = PANORAMA_HEIGHT;
    return true;
}

static bool read_head(const char *name, uint8_t head[FILE_HEAD_SIZE], struct error *error) {
    struct file_source source;
    memset(head, 0, FILE_HEAD_SIZE);
    if (!file_source_open(&source, name, error))
        return false;
    (void)file_source_read(&source, 0, head, FILE_HEAD_SIZE);
    file_source_close(&source);
    return true;
}

static bool open_file(struct view *view, struct error *error) {
    const char *name = view->options->scripts[0];
    uint8_t head[FILE_HEAD_SIZE];
    if (!read_head(name, head, error))
        return false;
    view->is_field = light_field_is(head, sizeof head);
    const char *dot = strrchr(name, '.');
    if (!view->is_field && !(dot && picture_format(name) == PICTURE_LIGHT_FIELD))
        return open_panorama(view, error);
    if (!light_field_open(&view->field, name, error))
        return false;
    view->is_field = true;
    view->tone = view->field.head.tone;
    view->width = view->field.head.width;
    view->height = view->field.head.height;
    return true;
}

/* --- pictures --- */

static struct vec3 point_of_frame(const struct view *view, uint32_t frame) {
    uint32_t steps = view->options->script.frames.loops ? view->frames : view->frames - 1;
    double t = steps > 0 ? (double)frame / steps * (view->point_count - 1) : 0;
    uint32_t first = (uint32_t)t;
    if (first + 1 >= view->point_count)
        return view->points[view->point_count - 1];
    struct vec3 a = view->points[first], b = view->points[first + 1];
    return t == first ? a : vec3_add_scaled(a, vec3_sub(b, a), t - first);
}

struct view_state view_state_of(const struct view *view, uint32_t frame) {
    const struct options *options = view->options;
    const struct vec3 at = point_of_frame(view, frame);
    const double focus = options->focus > 0 ? options->focus : view->field.head.screen - at.z;
    return (struct view_state){{at.x, at.y, at.z, focus, options->aperture, view->width, view->height, false},
                               options->fov > 0 ? options->fov : PANORAMA_FOV};
}

/* A panorama as the sky around the camera of a picture. */
struct panorama {
    struct view *view;
    struct camera_frame camera;
};

static void panorama_row(void *context, uint32_t y, int worker) {
    const struct panorama *panorama = context;
    struct view *view = panorama->view;
    (void)worker;
    for (uint32_t x = 0; x < view->width; x++) {
        struct ray ray = camera_ray(&panorama->camera, x + 0.5, y + 0.5);
        struct colour c = sky_colour(&view->sky, vec3_normalize(ray.direction), panorama->camera.spread);
        float *out = view->light[(size_t)y * view->width + x];
        out[0] = (float)c.r, out[1] = (float)c.g, out[2] = (float)c.b;
    }
}

static bool draw_panorama(struct view *view, const struct view_state *state, struct error *error) {
    const struct settings settings = settings_default();
    struct panorama panorama = {.view = view};
    double sine[2], cosine[2];
    char warning[256];
    el_sincos(state->camera.x * (PI / 180), &sine[0], &cosine[0]);
    el_sincos(state->camera.y * (PI / 180), &sine[1], &cosine[1]);
    /* A map has -z in its middle, a cross +z. */
    const double front = view->sky.kind == SKY_MAP ? -1 : 1;
    const struct camera camera = {.view = {-front * sine[0] * cosine[1], sine[1], front * cosine[0] * cosine[1]},
                                  .up = {front * sine[0] * sine[1], cosine[1], -front * cosine[0] * sine[1]},
                                  .fov = state->fov};
    return camera_prepare(&camera, &settings, (struct picture_size){view->width, view->height}, &panorama.camera,
                          warning, error) &&
           (pool_run(view->pool, view->height, panorama_row, &panorama) ||
            error_set(error, ERROR_CANCELLED, "interrupted"));
}

static bool resize(struct view *view, uint32_t width, uint32_t height, struct error *error) {
    float(*light)[3] = mem_resize_array(view->light, (size_t)width * height, sizeof *light);
    if (!light)
        return error_no_memory(error, "the picture");
    view->light = light;
    view->width = width;
    view->height = height;
    return true;
}

bool view_draw(struct view *view, const struct view_state *state, struct error *error) {
    struct light_field_camera camera = state->camera;
    if (!resize(view, camera.width, camera.height, error))
        return false;
    if (!view->is_field)
        return draw_panorama(view, state, error);
    (void)light_field_clamp(&view->field.head, &camera);
    return light_field_draw(&view->field, &camera, view->pool, view->light, error);
}

static bool draw(struct view *view, uint32_t frame, struct error *error) {
    struct view_state state = view_state_of(view, frame);
    return view_draw(view, &state, error);
}

/* All views of the field in one picture. */
static bool draw_all_views(struct view *view, struct error *error) {
    const struct light_field_head *head = &view->field.head;
    const struct light_field_part all = {0, 0, head->columns, head->rows};
    if (!light_field_load_part(&view->field, &all, view->pool, error) ||
        !resize(view, head->columns * head->width, head->rows * head->height, error))
        return false;
    for (uint32_t y = 0; y < view->height; y++) {
        for (uint32_t x = 0; x < view->width; x++) {
            const float *from = view->field.views[y / head->height * head->columns + x / head->width];
            size_t at = (size_t)(y % head->height) * head->width + x % head->width;
            memcpy(view->light[(size_t)y * view->width + x], from + at * LIGHT_FIELD_NUMBERS, sizeof *view->light);
        }
    }
    return true;
}

/* --- files --- */

static void row_light(void *context, uint32_t y, float *line) {
    const struct view *view = context;
    memcpy(line, view->light[(size_t)y * view->width], view->width * sizeof *view->light);
}

static double number_at(const struct view *view, uint32_t y, uint32_t i) {
    return tone_apply(&view->tone, (double)view->light[(size_t)y * view->width + i / 3][i % 3]);
}

static void row_bytes(void *context, uint32_t y, uint8_t *line) {
    const struct view *view = context;
    for (uint32_t i = 0; i < 3 * view->width; i++)
        line[i] = png_write_byte(number_at(view, y, i));
}

static void row_words(void *context, uint32_t y, uint16_t *line) {
    const struct view *view = context;
    for (uint32_t i = 0; i < 3 * view->width; i++)
        line[i] = tone_word(number_at(view, y, i));
}

bool view_write(struct view *view, const char *name, struct error *error) {
    const struct picture_source source = {.width = view->width,
                                          .height = view->height,
                                          .bytes = row_bytes,
                                          .words = row_words,
                                          .light = row_light,
                                          .context = view,
                                          .deep = view->options->settings.deep,
                                          .srgb = view->tone.srgb};
    const struct file_target target = {.path = name, .rules = &view->files.picture};
    return picture_file_write(&target, &source, view->pool, error);
}

static bool write_picture(struct view *view, uint32_t frame, struct error *error) {
    char name[NAME_LIMIT];
    return (output_name(view->options->output, frame + 1, name, sizeof name) ||
            error_set(error, ERROR_USAGE, "-o: the name is longer than %d bytes", NAME_LIMIT - 1)) &&
           view_write(view, name, error);
}

static bool frame_bytes(void *context, uint32_t index, uint8_t *rgb, struct error *error) {
    struct view *view = context;
    bool ok = draw(view, index, error);
    for (uint32_t y = 0; ok && y < view->height; y++)
        row_bytes(view, y, rgb + (size_t)3 * view->width * y);
    return ok;
}

static bool write_animation(struct view *view, struct error *error) {
    const struct frame_options *frames = &view->options->script.frames;
    const struct animation_source source = {.width = view->width,
                                            .height = view->height,
                                            .count = view->frames,
                                            .rate = frames->rate > 0 ? frames->rate : FRAME_RATE_DEFAULT,
                                            .loops = frames->loops,
                                            .srgb = view->tone.srgb,
                                            .frame = frame_bytes,
                                            .context = view};
    return animation_write(&view->files, &source, error);
}

static bool write_all(struct view *view, struct error *error) {
    if (view->options->contact_sheet)
        return draw_all_views(view, error) && write_picture(view, 0, error);
    if (view->options->animation != ANIMATION_NONE)
        return write_animation(view, error);
    bool ok = true;
    for (uint32_t frame = 0; ok && frame < view->frames; frame++)
        ok = draw(view, frame, error) && write_picture(view, frame, error);
    return ok;
}

/* The plane in focus is in front of the eye and of the cameras. One warning for all frames. */
static bool check_eyes(const struct view *view, struct error *error) {
    bool outside = false;
    for (uint32_t frame = 0; frame < view->frames; frame++) {
        struct light_field_camera camera = view_state_of(view, frame).camera;
        if (!(camera.focus > 0 && camera.focus + camera.z > 0))
            return error_set(error, ERROR_USAGE, "--eye: %g is behind the plane in focus, %g from the cameras",
                             camera.z, camera.focus + camera.z);
        outside = light_field_clamp(&view->field.head, &camera) || outside;
    }
    if (outside && !view->options->quiet)
        text_print_message(stderr, TEXT_WARNING,
                           "gray: warning: --eye: rays from outside of the field are taken from its border");
    return true;
}

static bool prepare(struct view *view, struct error *error) {
    const struct options *options = view->options;
    const char *path = options->eyes ? options->eyes : options->directions;
    char warning[256];
    struct file_identity identity;
    view->frames = options->script.frames.selection.step > 0 ? options->script.frames.selection.last : 1;
    if (!check_options(view, error))
        return false;
    view->point_count = !path;
    if (path && !read_points(view, options->eyes ? "--eye" : "--direction", path, options->eyes ? 3 : 2, error))
        return false;
    if (options->width) {
        view->width = (uint32_t)options->width;
        view->height = (uint32_t)options->height;
    }
    if (view->is_field && !check_eyes(view, error))
        return false;
    if (file_identity_of(options->scripts[0], &identity))
        picture_files_keep(&view->files, identity, false);
    view->pool = pool_create(options->threads, warning);
    return view->pool || error_no_memory(error, "the picture");
}

bool view_is(const char *name) {
    struct error ignored;
    uint8_t head[FILE_HEAD_SIZE];
    return read_head(name, head, &ignored) && picture_file_is(head, sizeof head);
}

struct view *view_open(const struct options *options, struct error *error) {
    /* Not on the stack, which may be small. */
    struct view *view = mem_alloc_zero(1, sizeof *view);
    if (!view) {
        (void)error_no_memory(error, "the picture");
        return NULL;
    }
    view->options = options;
    picture_files_init(&view->files, options);
    if (open_file(view, error) && prepare(view, error))
        return view;
    (void)view_close(view, NULL);
    return NULL;
}

int view_close(struct view *view, const struct error *error) {
    if (view) {
        mem_free(view->light);
        pool_destroy(view->pool);
        light_field_close(&view->field);
        image_release(view->image);
        picture_files_destroy(&view->files);
        mem_free(view);
    }
    return error ? text_print_error(error) : 0;
}

int view_run(const struct options *options) {
    struct error error;
    struct view *view = view_open(options, &error);
    return view_close(view, view && write_all(view, &error) ? NULL : &error);
}
